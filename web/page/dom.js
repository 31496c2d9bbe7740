// Small helpers for plain HTML.

/** An element: h("button.main", { onclick }, "text", child, …). */
export function h(name, attributes = {}, ...children) {
  const [tag, ...classes] = name.split(".");
  const element = document.createElement(tag);
  if (classes.length) element.className = classes.join(" ");
  for (const [key, value] of Object.entries(attributes))
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key in element && key !== "list" && key !== "role") element[key] = value;
    else if (value !== null && value !== undefined) element.setAttribute(key, value);
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export const group = (title, ...children) => h("section.group", { "aria-label": title }, h("h2", {}, title), ...children);

/** A slider with its value beside its label. */
export function slider(label, { min, max, step, value, format = String, change, commit }) {
  const output = h("output", {}, format(value));
  const input = h("input", { type: "range", min, max, step, value });
  input.addEventListener("input", () => {
    output.textContent = format(Number(input.value));
    change(Number(input.value));
  });
  input.addEventListener("change", () => commit?.());
  const element = h("label.field", {}, h("span", {}, `${label} `, output), input);
  return {
    element,
    set(next) {
      input.value = next;
      output.textContent = format(Number(next));
    },
    input,
  };
}

export function select(label, choices, value, change) {
  const box = h("select", { onchange: () => change(box.value) }, ...choices.map(([name, text]) => h("option", { value: name }, text ?? name)));
  box.value = value;
  return { element: h("label.field", {}, h("span", {}, label), box), box, set: (next) => (box.value = next) };
}

export function check(label, checked, change) {
  const box = h("input", { type: "checkbox", checked, onchange: () => change(box.checked) });
  return { element: h("label.check", {}, box, h("span", {}, label)), box, set: (next) => (box.checked = next) };
}

export function table(head, rows) {
  return h(
    "div.scroll",
    { tabIndex: 0, role: "group", "aria-label": head.join(", ") },
    h("table", {}, h("thead", {}, h("tr", {}, ...head.map((text) => h("th", { scope: "col" }, text)))), h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((text) => h("td", {}, text)))))),
  );
}

/** What a reader notes about a file, a paragraph each, below the figures. */
export const notes = (texts) => (texts ?? []).map((text) => h("p.hint.note", {}, `${text[0].toUpperCase()}${text.slice(1)}.`));

/** A canvas as large as its parent, in pixels of the device. */
export function sized(canvas) {
  const { width, height } = canvas.parentElement.getBoundingClientRect();
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, t] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  if (canvas.width !== w || canvas.height !== t) {
    canvas.width = w;
    canvas.height = t;
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

export const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export function digits(value, count = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return "∞";
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return String(value);
  return Math.abs(value) >= 1e-4 && Math.abs(value) < 1e7 ? String(Number(value.toPrecision(count))) : value.toExponential(count - 2);
}

export function download(name, data, type = "application/octet-stream") {
  const link = h("a", { href: URL.createObjectURL(new Blob([data], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Buttons that download a file of each format, as [name, title]; those that cannot hold the data tell why. */
export function downloads(formats, save) {
  const buttons = formats.map(([name, title]) => [name, h("button", { type: "button", onclick: () => save(name) }, title ?? name.toUpperCase())]);
  return {
    elements: buttons.map(([, button]) => button),
    /** Reasons by names of formats. */
    refuse(reasons) {
      for (const [name, button] of buttons) {
        button.disabled = Boolean(reasons[name]);
        button.title = reasons[name] ?? "";
      }
    },
  };
}

/** A button that opens a file, beside dropping one. */
export function opener(label, accept, open) {
  const input = h("input", { type: "file", accept, hidden: true, onchange: () => input.files[0] && open(input.files[0]).finally(() => (input.value = "")) });
  return h("span.files", {}, h("button", { type: "button", onclick: () => input.click() }, label), input);
}

/** The enumerator of the library for a choice: ("mesh_scheme", "catmull-clark") is BAT_MESH_SCHEME_CATMULL_CLARK. */
export const enumerator = (family, name) => `BAT_${family}_${name}`.replaceAll("-", "_").toUpperCase();

/** The endings of files of the formats that are read, as a file dialog takes them. */
export const endings = (formats) => formats.filter(({ reads }) => reads).flatMap((format) => format.endings.split(" ")).filter(Boolean).join(",");

/** The format that a file's ending names, as an option of reading; none where formats share the ending with others. */
export function formatOf(formats, file) {
  const ending = file.toLowerCase().match(/\.[a-z0-9]+$/)?.[0];
  const named = formats.filter(({ reads, endings: list }) => reads && ending && ending !== ".txt" && list.split(" ").includes(ending));
  return named.length === 1 ? { format: named[0].name } : {};
}

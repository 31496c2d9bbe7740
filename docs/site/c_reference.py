"""Write the reference of the C library from its headers, as pages for Sphinx.

A header becomes a page: its description, then each enumeration, struct, function, constant and type with its comment. The
comments are those of `///`, with `@param` and `@return`. Names become links and entries of the search.
"""

import re
from pathlib import Path

COMMENT = re.compile(r"^\s*///\s?(.*)$")


def inline(text: str) -> str:
    """A comment as reStructuredText."""
    parts = re.split(r"(`[^`]+`)", text)
    for i, part in enumerate(parts):
        if part.startswith("`"):
            parts[i] = f"`{part}`"
            continue
        part = re.sub(r"([\\*|])", r"\\\1", part)
        part = re.sub(r"\b(bat_\w+)\(\)", r":c:func:`\1`", part)
        part = re.sub(r"(?<![`\w])(bat_\w+|BAT_\w+)(?![\w`])(?!::)", r"``\1``", part)
        parts[i] = re.sub(r"(?<=\w)_(?=[\s,.;:)]|$)", r"\\_", part)
    # A literal stands between blanks or marks.
    return re.sub(r"(\w)?(``[^`]+``)([\w(])?", lambda m: (m[1] + "\\ " if m[1] else "") + m[2] + ("\\ " + m[3] if m[3] else ""), "".join(parts))


def paragraphs(lines: list[str]) -> list[str]:
    """Lines of a comment as text: paragraphs, parameters, results."""
    out: list[str] = []
    for line in lines:
        if line.startswith("    ") and not any(one.startswith("@") for one in lines[: lines.index(line)]):
            block = out and out[-1].startswith(".. code-block::")
            out[-1:] = [out[-1] + "\n   " + line[4:]] if block else [*out[-1:], "", ".. code-block:: c\n\n   " + line[4:]]
            continue
        found = re.match(r"@(param|return|see|file|name)\b\s*(.*)", line.strip())
        if found and found[1] == "param":
            name, _, rest = found[2].partition(" ")
            out.append(f":param {name.strip('`')}: {inline(rest.strip())}")
        elif found and found[1] == "return":
            out.append(f":returns: {inline(found[2])}")
        elif found:
            continue
        elif not line.strip():
            out.append("")
        elif out and out[-1]:
            out[-1] += " " + inline(line.strip())
        else:
            out.append(inline(line.strip()))
    text: list[str] = []
    for before, part in zip([""] + out, out):
        if text and not (part.startswith(":") and before.startswith(":")):
            text.append("")
        text += part.split("\n")
    return text


def indented(lines: list[str], width: int) -> list[str]:
    return [" " * width + line if line else "" for line in lines]


def code(text: str) -> str:
    """A declaration in one line."""
    return re.sub(r"\s+", " ", text.replace("BAT_API ", "")).strip().rstrip(";").strip()


def members(body: str, kind: str) -> list[str]:
    """The fields of a struct, or the values of an enumeration."""
    out: list[str] = []
    before: list[str] = []
    pending = ""
    last: list[str] | None = None
    entries: list[tuple[str, list[str]]] = []
    for line in body.split("\n"):
        text, mark, comment = re.match(r"^(.*?)\s*(?:(///<?)\s?(.*))?$", line).groups()
        pending = f"{pending} {text.strip()}".strip()
        done = pending.endswith(";") if kind == "struct" else bool(pending)
        if done:
            last = before + ([comment] if mark else [])
            entries.append((pending, last))
            before, pending = [], ""
        elif mark == "///<" and last is not None:
            last.append(comment)
        elif mark == "///" and not pending:
            before.append(comment)
    for text, comment in entries:
        if kind == "enum":
            name = text.rstrip(",").split("=")[0].strip()
            out += [f".. c:enumerator:: {name}", ""]
            out += indented(paragraphs(comment), 3) + [""]
            continue
        # Several fields of a type may share a line.
        text = text.rstrip(";")
        fields = [text]
        if "(" not in text and "," in text:
            head, *rest = [part.strip() for part in text.split(",")]
            base = re.sub(r"[*\s]*\w+(\[\w+\])*$", "", head)
            fields = [head] + [f"{base} {part}" for part in rest]
        for field in fields:
            # Sphinx takes these for keywords of C.
            word = re.search(r"\b(imaginary|complex)$", field)
            out += [f"``{code(field)}``", ""] if word else [f".. c:member:: {code(field)}", ""]
            out += indented(paragraphs(comment), 3) + [""]
    return out


DECLARATION = re.compile(
    r"typedef enum (?P<enum>\w+)\s*\{(?P<values>.*?)\n\s*\}\s*\w+;"
    r"|(?:typedef )?struct (?P<struct>\w+)\s*\{(?P<fields>.*?)\n\}[ \w]*;"
    r"|typedef struct (?P<opaque>\w+) \w+;"
    r"|typedef (?P<type>[^;{]+);"
    r"|#define (?P<macro>BAT_\w+)(?P<arguments>\([^)]*\))?[ \t]+(?P<value>[^\n]+)"
    r"|extern BAT_API (?P<variables>[^;]+);"
    r"|(?P<function>(?:BAT_API|static inline) [^;{]+?\))(?:;|\s*\{.*?\n\})",
    re.S,
)


def page(header: Path) -> tuple[str, list[str]]:
    text = header.read_text()
    lines = [f"{header.name}", "=" * len(header.name), ""]
    about = re.search(r"/// @file\n((?:///.*\n)+)", text)
    if about:
        lines += paragraphs([COMMENT.match(line)[1] for line in about[1].splitlines()]) + [""]
        text = text.replace(about[0], "\n")
    lines += [f".. code-block:: c", "", f"   #include <batten/{header.name}>", ""]
    names: list[str] = []
    at = text.find("BAT_C_BEGIN\n\n") + 1
    while True:
        found = DECLARATION.search(text, at)
        if not found:
            break
        comment: list[str] = []
        for line in reversed(text[: found.start()].rstrip("\n ").split("\n")):
            mark = COMMENT.match(line)
            if not mark or mark[1].strip() in ("@{", "@}") or mark[1].startswith("@name") or line.strip().startswith("///<"):
                break
            comment.insert(0, mark[1])
        between = text[at : found.start()]
        for title in re.findall(r"/// @name (.*)", between):
            lines += [f".. rubric:: {title}", ""]
        at = found.end()
        part = found.groupdict()
        if part["enum"]:
            head, body = f".. c:enum:: {part['enum']}", members(part["values"], "enum")
            names.append(part["enum"])
        elif part["struct"]:
            head, body = f".. c:struct:: {part['struct']}", members(part["fields"], "struct")
            names.append(part["struct"])
        elif part["opaque"]:
            if re.search(rf"struct {part['opaque']}\s*\{{", text):
                continue
            head, body = f".. c:struct:: {part['opaque']}", []
            names.append(part["opaque"])
        elif part["type"]:
            head, body = f".. c:type:: {code(part['type'])}", []
        elif part["macro"]:
            if part["macro"] in ("BAT_API", "BAT_C_BEGIN", "BAT_C_END"):
                continue
            head, body = f".. c:macro:: {part['macro']}{part['arguments'] or ''}", []
            comment.append(f"`{re.split(r' *///', part['value'])[0].strip()}`")
        elif part["variables"]:
            base, *more = [one.strip() for one in code(part["variables"]).split(",")]
            kind = base.rsplit(" ", 1)[0]
            head, body = "\n".join([f".. c:var:: {base}"] + [f"             {kind} {one}" for one in more]), []
            names.append(base.rsplit(" ", 1)[1])
        else:
            head, body = f".. c:function:: {code(part['function'])}", []
            names.append(re.search(r"(\w+)\(", code(part["function"]))[1])
        lines += [head, ""] + indented(paragraphs(comment), 3) + [""] + indented(body, 3) + [""]
    return "\n".join(lines), names


def write(include: Path, folder: Path) -> None:
    """Pages of all headers in folder/c, and folder/c-reference.rst."""
    target = folder / "c"
    target.mkdir(parents=True, exist_ok=True)
    ordered = re.findall(r'#include "batten/([a-z_]+\.h)"', (include / "batten.h").read_text())
    rows = []
    for name in [name for name in dict.fromkeys(["base.h", *ordered]) if name != "config.h"]:
        header = include / name
        text, names = page(header)
        declared = {found for found in re.findall(r"\b(bat_\w+)\([^()]*(?:\([^()]*\)[^()]*)*\);", header.read_text())}
        missing = [one for one in declared if one not in names and f"BAT_API" in header.read_text() and re.search(rf"BAT_API [^;]*\b{one}\(", header.read_text())]
        if missing:
            raise SystemExit(f"c_reference: {name}: no entry for {', '.join(sorted(missing))}")
        (target / f"{header.stem}.rst").write_text(text)
        about = re.search(r"/// @file\n/// (.*(?:\n/// .+)*)", header.read_text())
        first = re.sub(r"\n/// ?", " ", about[1]) if about else ""
        rows.append(f"   * - :doc:`{name} <c/{header.stem}>`\n     - {inline(re.split(r'(?<=[.:]) ', first)[0].rstrip(':.'))}\n")
    tree = "".join(f"   c/{path.stem}\n" for path in sorted(target.glob("*.rst")))
    (folder / "c-reference.rst").write_text(
        "C reference\n===========\n\nThe functions and types of the public headers. ``#include <batten/batten.h>`` has all of them. Every call "
        "that can fail returns a :c:enum:`bat_status` and fills a :c:struct:`bat_error`; options may be null.\n\n"
        ".. list-table::\n   :widths: 30 70\n\n" + "".join(rows) + "\n.. toctree::\n   :hidden:\n\n" + tree
    )

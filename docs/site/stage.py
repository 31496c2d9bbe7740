"""Copy the pages of the project into a folder from which Sphinx makes a site.

    python stage.py FOLDER

The pages stay as they are, in the same folders, so that their links hold. The sections of docs/index.md become pages with a
tree of what they link to; the examples in C get a page; what else the site needs lies beside this script.
"""

import re
import shutil
import sys
from pathlib import Path

import c_reference

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COPIED = ["docs/**/*.md", "docs/images/**/*", "docs/tutorials/*.py", "weights/*.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "README.md", "LICENSE",
          "CITATION.cff", "packaging/README.md", "web/npm/README.md", ".github/*.md", "examples/*.c", "examples/data/*"]  # fmt: skip
#: What GitHub shows by itself, and no page links to.
FORMS = [".github/PULL_REQUEST_TEMPLATE.md"]
LINK = re.compile(r"(\]\()([^)#:]+)(#[^)]*)?\)")


def sections(text: str) -> list[tuple[str, str]]:
    """Title and body of each section of the second level."""
    parts = re.split(r"^## (.+)\n", text, flags=re.M)
    return list(zip(parts[1::2], parts[2::2]))


def section_page(title: str, body: str) -> str:
    """A page of a section of docs/index.md: its text, and the tree of its links."""
    rooted = LINK.sub(lambda link: f"]({moved(link[2])}{link[3] or ''})", body)
    pages = dict.fromkeys(moved(link[2]) for link in LINK.finditer(body) if link[2].endswith((".md", ".py")))
    tree = "\n".join(pages)
    return f"# {title}\n\n{rooted.strip()}\n\n```{{toctree}}\n:hidden:\n\n{tree}\n```\n"


def moved(target: str) -> str:
    """A link of docs/index.md as one of a page in the root."""
    return target.removeprefix("../") if target.startswith("../") else f"docs/{target}"


def examples_page() -> str:
    page = "# Examples in C\n\nThe programs of the folder `examples/`, which the build compiles.\n"
    for program in sorted((ROOT / "examples").glob("*.c")):
        page += f"\n## {program.name}\n\n```{{literalinclude}} {program.name}\n:language: c\n```\n"
    return page


def main() -> None:
    folder = Path(sys.argv[1])
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    for pattern in COPIED:
        for source in sorted(ROOT.glob(pattern)):
            if HERE in source.parents or not source.is_file() or str(source.relative_to(ROOT)) in FORMS:
                continue
            target = folder / source.relative_to(ROOT)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    for source in HERE.iterdir():
        if source.suffix in (".rst", ".css") or source.name == "conf.py":
            place = "_static" if source.suffix == ".css" else "_templates/autosummary" if source.name == "class.rst" else ""
            target = folder / place / source.name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    # GitHub shows a folder where a page links to one.
    for page in folder.rglob("*.md"):
        text = page.read_text()
        page.write_text(re.sub(r"\]\(((?:\.\./)*examples/)\)", r"](\1index.md)", text))
    (folder / "examples/index.md").write_text(examples_page())
    c_reference.write(ROOT / "include/batten", folder)
    index = folder / "docs/index.md"
    linked = {moved(link[2]) for link in LINK.finditer(index.read_text())}
    for title, body in sections(index.read_text()):
        (folder / f"{title.lower().replace(' ', '-')}.md").write_text(section_page(title, body))
    # Pages that stand in no tree.
    others = [page for page in (folder / ".github").glob("*.md") if str(page.relative_to(folder)) not in linked]
    for page in (index, folder / "README.md", folder / "examples/index.md", folder / "web/npm/README.md", *others):
        page.write_text("---\norphan: true\n---\n\n" + page.read_text())


if __name__ == "__main__":
    main()

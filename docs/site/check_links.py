"""Fail if a page of a site links to a page, an anchor or a picture that the site does not have, or shows a directive.

    python check_links.py SITE

Links to other sites are checked for their form alone.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The anchors of a page and what it links to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = {"", "top"}
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.add(value or "")
            elif name in ("href", "src") and value and tag != "base":
                self.links.append(value)


def main() -> int:
    root = Path(sys.argv[1]).resolve()
    pages = {path: Page(path.read_text()) for path in root.rglob("*.html") if root / "_static" not in path.parents}
    broken, count = [], 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            count += 1
            if parts.scheme in ("http", "https"):
                if "." not in parts.netloc:
                    broken.append((path, link))
                continue
            if parts.scheme:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists() or (target in pages and unquote(parts.fragment) not in pages[target].anchors):
                broken.append((path, link))
    for path in pages:
        if "<p>.. " in path.read_text():
            broken.append((path, "what a directive names"))
    for path, link in broken:
        print(f"docs: {path.relative_to(root)}: the link to {link} leads nowhere", file=sys.stderr)
    print(f"{len(pages)} pages, {count} links, {len(broken)} broken")
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    sys.exit(main())

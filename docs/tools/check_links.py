# SPDX-License-Identifier: MIT
"""Names every link of a built site to a file or an anchor that is not there: `check_links.py FOLDER`."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The links of a page, and the anchors that it has."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called with each start tag."""
        found = {name: value or "" for name, value in attrs}
        self.links += [found[name] for name in ("href", "src", "poster", "data") if name in found]
        self.links += [part.split()[0] for part in found.get("srcset", "").split(",") if part.strip()]
        self.anchors |= {found[name] for name in ("id", "name") if name in found}


def broken_links(site: Path) -> list[str]:
    """Page and link of each that leads nowhere."""
    pages = {
        path.resolve(): Page(path) for path in sorted(site.rglob("*.html")) if path.parent.name != "_static"
    }
    broken = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            anchors = pages[target].anchors if target in pages else {parts.fragment}
            if not target.exists() or parts.fragment not in {"", *anchors}:
                broken.append(f"{path.relative_to(site.resolve())}: {link}")
    print(
        f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links, {len(broken)} broken"
    )
    return broken


if __name__ == "__main__":
    sys.exit("\n".join(broken_links(Path(sys.argv[1]))) or 0)

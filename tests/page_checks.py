"""What is wrong with a page: checks that need no browser."""

import re
from html.parser import HTMLParser
from pathlib import Path

VOID = {"meta", "img", "br", "input", "link", "hr"}
BLOCKS = set("p div ul ol dl table section figure details fieldset h1 h2 h3 h4".split())


class PageReader(HTMLParser):
    """Tags with their attributes, text in its order, and what does not fit together."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.wrong, self.open, self.headings = [], [], [], []
        self.text = self.title = ""
        self.feed(text)
        self.wrong += [f"<{tag}> is not closed" for tag in self.open]

    def handle_starttag(self, tag, attrs):
        if len({name for name, _ in attrs}) < len(attrs):
            self.wrong.append(f"<{tag}> has an attribute twice")
        if tag in BLOCKS and "p" in self.open:
            self.wrong.append(f"<{tag}> in a paragraph")
        if "a" in self.open and tag in ("a", "summary"):
            self.wrong.append(f"<{tag}> in a link")
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"</{tag}> closes what is not open")

    def handle_data(self, data):
        if "title" in self.open:
            self.title += data
        elif "style" not in self.open:
            self.text += data

    def all(self, name):
        """The attributes of the tags of a name."""
        return [attributes for tag, attributes in self.tags if tag == name]

    @property
    def ids(self):
        """The places in the page, in their order."""
        return [each["id"] for _, each in self.tags if "id" in each]


def faults_of(page: PageReader) -> list[str]:
    """What does not hold of one page by itself."""
    twice = sorted({each for each in page.ids if page.ids.count(each) > 1})
    steps = [b for a, b in zip([0, *page.headings], page.headings, strict=False) if b > a + 1]
    return [
        *page.wrong,
        *(f"id {each} twice" for each in twice),
        *(f"a heading of level {each} below one more than a level up" for each in steps),
        *(["not one heading of level 1"] if page.headings.count(1) != 1 else []),
        *(
            f"{each.get('src', 'an image')[:60]} without a text"
            for each in page.all("img")
            if not each.get("alt")
        ),
        *(["a script"] if page.all("script") else []),
    ]


def broken_links(pages: dict[str, PageReader], folder: Path) -> list[str]:
    """Links and pictures whose file or place is not there; `page: link`."""
    broken = []
    for name, page in pages.items():
        links = [each.get("href", "") for each in page.all("a")] + [each["src"] for each in page.all("img")]
        for link in links:
            target, _, place = link.partition("#")
            if re.match(r"https://doi\.org/10\.|data:image/png;base64,", link):
                continue
            there = (folder / target).is_file() if target else True
            if not there or (place and place not in pages[target or name].ids):
                broken.append(f"{name}: {link}")
    return broken

# SPDX-License-Identifier: MIT
"""The built site in a browser, by hand: accessibility by axe-core, sideways scrolling, and the search.

    python3 -m venv browser && browser/bin/pip install playwright axe-playwright-python
    apt-get install --no-install-recommends chromium     # or: browser/bin/playwright install chromium
    browser/bin/python docs/tools/check_browser.py docs/_build/html [FOLDER for screenshots]

Each page is opened at 1280 and 390 pixels, light and dark.
"""

import shutil
import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, sync_playwright

PAGES = [
    "index.html",
    "guide/index.html",
    "guide/first-contact.html",
    "guide/which-model.html",
    "guide/limits.html",
    "guide/scenes.html",
    "guide/results.html",
    "theory.html",
    "equations.html",
    "api.html",
    "api/closed_forms.html",
    "auto_gallery/index.html",
    "verification/index.html",
    "verification/plastic.html",
]


class Quiet(SimpleHTTPRequestHandler):
    """A server that does not tell of each request."""

    def log_message(self, format: str, *args: object) -> None:
        """Nothing."""


def faults(page: Page) -> list[str]:
    """What is wrong with a page as it is shown."""
    found = [
        f"axe, {rule['impact']}: {rule['id']}, {len(rule['nodes'])} times"
        f", as {rule['nodes'][0]['html'][:120]}"
        f" ({' '.join(rule['nodes'][0]['failureSummary'].split())[:300]})"
        for rule in Axe().run(page).response["violations"]
    ]
    width, shown = page.evaluate("[document.documentElement.scrollWidth, window.innerWidth]")
    return found + ([f"{width} pixels wide, {shown} shown"] if width > shown else [])


def main(site: Path, pictures: Path | None = None) -> int:
    """1 where anything is wrong."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}"
    gallery = sorted(site.glob("auto_gallery/**/*.html"))
    pages = [*PAGES, *[str(path.relative_to(site)) for path in gallery if path.stem != "index"][:1]]
    wrong = 0
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        for width in (1280, 390):
            for scheme in ("light", "dark"):
                context = browser.new_context(
                    viewport={"width": width, "height": 900}, color_scheme=scheme, reduced_motion="reduce"
                )
                page = context.new_page()
                for name in pages:
                    page.goto(f"{address}/{name}")
                    found = faults(page)
                    wrong += len(found)
                    print(f"{name}, {width} pixels, {scheme}: {'; '.join(found) or 'good'}")
                    if pictures:
                        pictures.mkdir(exist_ok=True)
                        page.screenshot(path=pictures / f"{name.replace('/', '-')}-{width}-{scheme}.png")
                page.goto(f"{address}/search.html?q=friction")
                page.wait_for_selector("#search-results li")
                context.close()
        browser.close()
    print(f"{wrong} faults")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))

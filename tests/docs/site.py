#!/usr/bin/env python3
"""Builds the documentation as a site and checks that no page asks the network for anything, that every link and heading
that is linked exists, that lists are lists, and that the search finds a word: opened as a file, and from a server.
Usage: site.py [FOLDER_FOR_SCREENSHOTS]; exit code 77 where mkdocs, its theme or chromium is missing."""
import functools
import http.server
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests/app"))
import chromium  # noqa: E402

LOADED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "object": "data", "video": "src"}
# A word of the documentation, and the page that is to be among the first that are found.
WANTED = {"per_increment": "guides/generate.html", "charuco": "guides/boards.html", "joint_memroc": "reference/methods.html"}


class Page(HTMLParser):
    """What a page loads, what it links, and which of its places have names."""

    def __init__(self, file):
        super().__init__()
        self.loaded, self.links, self.names, self.unlisted = [], [], set(), []
        self._inside = []
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.names.update(given[key] for key in ("id", "name") if given.get(key))
        if given.get(LOADED.get(tag, "")):
            self.loaded.append(given[LOADED[tag]])
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag in ("article", "pre"):
            self._inside.append(tag)

    def handle_endtag(self, tag):
        if self._inside[-1:] == [tag]:
            self._inside.pop()

    def handle_data(self, data):
        if self._inside == ["article"]:
            self.unlisted += re.findall(r"\n *(?:- |\d+\. |\|).*", data)


def is_remote(address):
    return address.startswith("//") or urlsplit(address).scheme in ("http", "https", "ws", "wss", "ftp")


def leads_nowhere(file, address, pages):
    parts = urlsplit(address)
    if parts.scheme or address.startswith("//"):
        return False
    target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
    if target.is_dir():
        target /= "index.html"
    if not target.is_file():
        return True
    return bool(parts.fragment) and target in pages and unquote(parts.fragment) not in pages[target].names


def wrong_in_files(site):
    pages = {file: Page(file) for file in sorted(site.rglob("*.html")) if file.name != "404.html"}
    for file, page in pages.items():
        for address in page.loaded:
            if is_remote(address):
                yield f"{file.relative_to(site)}: loads {address}"
        for text in page.unlisted:
            yield f"{file.relative_to(site)}: a list or table that lacks an empty line before it: {text.strip()}"
        for address in page.loaded + page.links:
            if leads_nowhere(file, address, pages):
                yield f"{file.relative_to(site)}: link to {address}, which does not exist"
    for file in site.rglob("*.css"):
        for address in re.findall(r"""(?:url\(|@import)\s*["']?([^"')\s]+)""", file.read_text(encoding="utf-8")):
            if is_remote(address):
                yield f"{file.relative_to(site)}: loads {address}"
    if len(pages) < 40:
        yield f"only {len(pages)} pages"


FOUND = """new Promise((done) => {
  const since = Date.now(), box = document.querySelector(".md-search__input");
  document.querySelector("#__search").checked = true;
  box.focus();
  box.value = WORD;
  box.dispatchEvent(new KeyboardEvent("keyup", {bubbles: true}));
  const look = () => {
    const links = [...document.querySelectorAll(".md-search-result__item a")].map((link) => link.href);
    links.length || Date.now() - since > 15000 ? done(links) : setTimeout(look, 50);
  };
  look();
})"""


def wrong_in_search(browser, home):
    for word, wanted in WANTED.items():
        browser.open(home)
        links = browser.js(FOUND.replace("WORD", repr(word)))
        if not any(wanted in link for link in links[:10]):
            yield f"{home}: searching for {word} finds {links[:10]}, not {wanted}"


def screenshots(browser, site, folder):
    for name, page, width, dark in (("start", "index.html", 1300, False), ("reference", "docs/reference/data-format.html", 1300, False),
                                    ("dark", "docs/theory/estimation.html", 1300, True), ("phone", "docs/tutorials/my-robot.html", 390, False)):
        browser.size(width, 900, width < 500)
        browser.dark(dark)
        browser.open((site / page).as_uri())
        browser.js("localStorage.clear()")  # of an earlier page's choice of light or dark
        browser.open((site / page).as_uri())
        (folder / f"{name}.png").write_bytes(browser.screenshot())
    browser.size(1300, 900)
    browser.dark(False)
    browser.open((site / "index.html").as_uri())
    browser.js(FOUND.replace("WORD", "'charuco'"))
    (folder / "search.png").write_bytes(browser.screenshot())


def serve(site):
    handler = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(handler, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


def wrong_in_browser(site, pictures):
    server = serve(site)
    browser = chromium.Chromium()
    try:
        yield from wrong_in_search(browser, (site / "index.html").as_uri())
        yield from wrong_in_search(browser, server + "index.html")
        yield from (f"a page asks for {address}" for address in browser.asked_for if not address.startswith(server))
        yield from (f"a page says {said}" for said in browser.said if '"error"' in said or "exceptionDetails" in said)
        if pictures:
            screenshots(browser, site, Path(pictures))
    finally:
        browser.close()


def main():
    if not shutil.which("mkdocs") or not Path("/usr/share/mkdocs/themes/material").is_dir() or not chromium.program():
        print("skipped: needs mkdocs, mkdocs-material and chromium (scripts/install-dependencies --test)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        site = Path(folder).resolve() / "site"
        if subprocess.run([TOP / "scripts/docs", site]).returncode != 0:
            return 1
        wrong = [*wrong_in_files(site), *wrong_in_browser(site, sys.argv[1] if sys.argv[1:] else None)]
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Checks that what the documentation points to exists: files and headings that a link in a Markdown file names, and
files under docs/ that sources, scripts and help texts name.
Usage: links.py [SOURCE_FOLDER]; exit code 1 and one line for each link that leads nowhere."""
import os
import re
import subprocess
import sys
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote

FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)")
MENTION = re.compile(r"(?<![\w/.-])docs/[\w./-]*\.(?:md|yaml|png|jpg)\b")
SKIPPED = {".git", "build", "runs", "sweeps", "paper"}
OF_BEFORE = "tests/compat/"  # files of earlier versions name documents of theirs


def sources(top):
    """Every tracked or new file that git does not ignore; without git, every file outside of build folders."""
    git = subprocess.run(["git", "-C", top, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                         capture_output=True)
    if git.returncode == 0:
        return sorted(path for name in git.stdout.decode().split("\0") if name and (path := top / name).is_file())
    found = []
    for folder, folders, files in os.walk(top):
        folders[:] = [name for name in folders if Path(folder) != top or name not in SKIPPED]
        found += [Path(folder) / name for name in files]
    return sorted(found)


def prose(text):
    """(line number, line) of what is not in a code block, code spans emptied."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            fenced = not fenced
        elif not fenced:
            yield number, re.sub(r"`[^`]*`", "``", line)


def anchor(heading):
    """The name that GitHub and GitLab give a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


@lru_cache(maxsize=None)
def anchors(path):
    names, fenced = [], False
    for line in path.read_text(encoding="utf-8").splitlines():
        if FENCE.match(line):
            fenced = not fenced
        elif not fenced and (heading := re.match(r"#{1,6}\s+(.*?)\s*#*$", line)):
            name = anchor(heading.group(1))
            names.append(f"{name}-{names.count(name)}" if name in names else name)
        elif not fenced:
            names += re.findall(r'<a (?:id|name)="([^"]+)"', line)
    return set(names)


def broken_links(page):
    for number, line in prose(page.read_text(encoding="utf-8")):
        for target in LINK.findall(line):
            if re.match(r"[a-z][a-z0-9+.-]*:", target):
                continue
            name, _, heading = unquote(target).partition("#")
            file = (page.parent / name).resolve() if name else page
            if not file.exists():
                yield number, f"link to {target}: there is no such file"
            elif heading and (file.suffix != ".md" or heading not in anchors(file)):
                yield number, f"link to {target}: the file has no such heading"


def broken_mentions(top, path):
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return
    for number, line in enumerate(text.splitlines(), 1):
        for name in MENTION.findall(line):
            if not (top / name).exists():
                yield number, f"names {name}, which does not exist"


def main():
    top = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2]).resolve()
    pages = wrong = 0
    for path in sources(top):
        is_of_before = path.name == "CHANGELOG.md" or path.relative_to(top).as_posix().startswith(OF_BEFORE)
        found = [] if is_of_before else list(broken_mentions(top, path))
        if path.suffix == ".md":
            pages += 1
            found += broken_links(path)
        wrong += len(found)
        for number, what in found:
            print(f"{path.relative_to(top)}:{number}: {what}")
    print(f"{pages} pages, {wrong} links that lead nowhere")
    return 1 if wrong or not pages else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Gives every `rigproof` command line of the documentation to the program's own parser: names of commands and options,
their values, and how many arguments there are. Nothing is run.
Usage: commands.py PROGRAM [SOURCE_FOLDER]; exit code 1 and one line for each command that the program does not take."""
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from links import FENCE

PLACEHOLDER = {"..", "...", "COMMAND"}
USAGE = "[OPTIONS]"  # what --help prints of the usage is no command line


def lines_of(page):
    """(line number, text, whether it is of a sentence) of fenced lines, continued ones joined, and of code in sentences."""
    fenced, begun, text = False, 0, ""
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if FENCE.match(line):
            fenced = not fenced
        elif fenced:
            begun, text = (begun, text + " " + line) if text else (number, line)
            if text.endswith("\\"):
                text = text[:-1]
                continue
            yield begun, text, False
            text = ""
        else:
            yield from ((number, code, True) for code in re.findall(r"`(rigproof [^`]*)`", line))


def words_of(text):
    """Words and operators as a shell has them; a line that is none, up to where it could be one."""
    lexer = shlex.shlex(text, posix=True, punctuation_chars=True)
    lexer.whitespace_split, words = True, []
    try:
        for word in lexer:
            words.append(word)
    except ValueError:
        pass
    return words


def is_operator(word):
    return bool(word) and set(word) <= set("();<>|&")


def commands_in(text):
    words = words_of(text)
    for at, word in enumerate(words[:-1]):
        if re.fullmatch(r"(.*/)?rigproof", word) and re.fullmatch(r"[a-z][a-z-]*|--?[a-z]\S*", words[at + 1]):
            end = next((k for k in range(at, len(words)) if is_operator(words[k])), len(words))
            if USAGE not in words:
                yield tuple(word for word in words[at + 1:end] if word not in PLACEHOLDER)


def refusal(program, arguments):
    """What the program says against the arguments."""
    answer = subprocess.run([program, *arguments], env={**os.environ, "RIGPROOF_PARSE_ONLY": "1"}, capture_output=True, text=True)
    return answer.stderr.strip() if answer.returncode != 0 else ""


def main():
    program = sys.argv[1]
    top = Path(sys.argv[2] if len(sys.argv) > 2 else Path(__file__).parents[2])
    pages = [top / "README.md", top / "CONTRIBUTING.md", *sorted((top / "docs").rglob("*.md")), *sorted((top / "config").rglob("*.md"))]
    found = []
    for page in pages:
        for number, text, in_sentence in lines_of(page):
            # A sentence need not name the input; asked for help, the program still looks at names.
            help_too = ("--help",) if in_sentence else ()
            found += [(f"{page.relative_to(top)}:{number}", command + help_too) for command in commands_in(text)]
    commands = sorted({command for _, command in found})
    with ThreadPoolExecutor() as threads:
        refused = dict(zip(commands, threads.map(lambda command: refusal(program, command), commands)))
    wrong = [(place, command) for place, command in found if refused[command]]
    for place, command in wrong:
        print(f"{place}: rigproof {shlex.join(command)}\n  {refused[command]}")
    print(f"{len(found)} commands in {len(pages)} pages, {len(wrong)} that the program does not take")
    return 1 if wrong or len(found) < 200 else 0


if __name__ == "__main__":
    sys.exit(main())

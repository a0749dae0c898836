#!/usr/bin/env python3
"""Compares docs/reference/cli.md with what the program's --help says.
Usage: cli.py PROGRAM SOURCE_FOLDER; with RIGPROOF_UPDATE_DOCS set the page is written anew instead."""
import os
import subprocess
import sys
from pathlib import Path

INTRODUCTION = """# The command line

What `rigproof COMMAND --help` prints; this page is written from it. Defaults stand behind an option's type
(`-j,--jobs INT=0`), the name of a variable of the environment in brackets.

| variable of the environment | |
|---|---|
| `RIGPROOF_CACHE` | folder of clean renders, as `--cache` |
| `RIGPROOF_DATA` | another folder with `models/`, `scenes/` and `config/` than the one beside the program |
| `RIGPROOF_PATH` | folders of your own of the same layout, separated by `:`; what they have comes before what ships |
| `RIGPROOF_OBSERVATIONS` | folder in which observations of recordings are kept, so that images that have not changed are not looked at again; empty: none are; default `rigproof/observations/` in `$XDG_CACHE_HOME` or `~/.cache` |
| `RIGPROOF_LIBEGL` | another EGL library than `libEGL.so.1` |
| `RIGPROOF_PARSE_ONLY` | set: a command line is checked, and nothing is done |
| `NO_COLOR` | set: no colours on a terminal |
| `LP_NUM_THREADS` | threads of Mesa's software renderer in each process; 1 unless you set it |

Files that are written appear whole, in place of a regular file of that name. A pipe or character device (`-o /dev/stdout`)
is written to; a link is refused. In `--json` a byte of a name that is no UTF-8 is U+FFFD; every
object that is printed has the `version` of the program (a list has none: its commands are `inspect`, `methods` and the like,
`scenes SCENE`, `paper`).

Completion comes with an installation; from a checkout: `source <(rigproof completion bash)` in `~/.bashrc`,
`rigproof completion zsh > _rigproof` in a folder of `$fpath`, `rigproof completion fish | source` in `config.fish`. It knows
the presets that are there when it is made, those in folders of `RIGPROOF_PATH` among them.
`rigproof manual > rigproof.1; man ./rigproof.1` is this page for `man`.
"""


def help_of(program, command):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("RIGPROOF")}
    return subprocess.run([program, *command, "--help"], env=environment, check=True, capture_output=True, text=True).stdout


def commands_in(text):
    """Names below the headings of groups of commands, in their order."""
    if "SUBCOMMAND" not in text:
        return []
    blocks = [block.splitlines() for block in text.split("\n\n")]
    groups = [lines[1:] for lines in blocks if lines[0] not in ("Options:", "Positionals:", "Example:") and lines[0].endswith(":")]
    return [line.split()[0] for lines in groups for line in lines if line.startswith("  ") and line[2] != " "]


def section(program, command):
    text = help_of(program, command)
    title = "rigproof " + " ".join(command)
    own = f"{'#' * (len(command) + 1)} {title.strip()}\n\n```\n{text.strip()}\n```\n"
    return [own] + [part for name in commands_in(text) for part in section(program, [*command, name])]


def main():
    program, page = sys.argv[1], Path(sys.argv[2]) / "docs/reference/cli.md"
    sections = section(program, [])
    sections[0] = sections[0].replace("# rigproof", "## rigproof", 1)
    text = "\n".join([INTRODUCTION, *sections])
    if os.environ.get("RIGPROOF_UPDATE_DOCS"):
        page.write_text(text, encoding="utf-8")
    elif not page.exists() or page.read_text(encoding="utf-8") != text:
        print(f"{page}: not what --help says; write it anew: RIGPROOF_UPDATE_DOCS=1 {' '.join(sys.argv)}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

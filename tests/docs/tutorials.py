#!/usr/bin/env python3
"""Works through a tutorial as its reader does, in an empty folder: writes the files that it shows, runs its commands in
their order, and looks for what it prints of them in what they print, whatever the numbers.
Usage: tutorials.py PROGRAM SOURCE_FOLDER TUTORIAL; exit code 1 with what went otherwise."""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# What takes longer than a test may is done smaller, or only planned.
SMALLER = {"rigproof run demo": "--set poses=8 --set image_scale=0.5", "rigproof paper table1": "--dry-run",
           "rigproof sweep start stress/": "--dry-run", "rigproof sweep start bench-v1/": "--dry-run"}
# Needs a robot, its bag, its URDF, or a shell that stays.
LEFT_OUT = ("ros2 ", "export PATH", "rigproof init monday_bag", "rigproof export monday/results/ml.yaml --to static-tf",
            "rigproof export monday/results/ml.yaml --into")
EXIT_CODES = {"rigproof calibrate runs/straight": 3, "rigproof calibrate monday/ --accept default": 1, "rigproof moved tuesday/": 1, "rigproof validate tests/lab": 1,
              "rigproof run demo": 1, "rigproof validate runs/side": 1}
# What another GL driver's pixels may change in more than numbers.
DEPENDS_ON_PIXELS = ("rigproof suggest",)


def blocks_of(page):
    """(language, text) of fenced blocks."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def steps_of(text):
    """(command, lines that it prints) of a block; one that shows a terminal has `$` before what is typed."""
    lines = text.replace("\\\n", " ").splitlines()
    if not any(line.startswith("$ ") for line in lines):
        return [(line, []) for line in lines if re.match(r"(rigproof|cp|mkdir|sed) ", line)]
    steps = []
    for line in lines:
        if line.startswith("$ "):
            steps.append((line[2:], []))
        elif line.strip() not in ("", "..."):
            steps[-1][1].append(line)
    return steps


def shape(line):
    return " ".join(re.sub(r"[-+]?[.\d]+(e[-+]?\d+)?|\d+", "#", line).replace("+-", " ").replace("-#", "#").split())


class Reader:
    def __init__(self, program, source, folder):
        self.source, self.folder, self.wrong = source, folder, []
        self.environment = {**os.environ, "PATH": f"{Path(program).resolve().parent}:{os.environ['PATH']}"}

    def write(self, text):
        if name := re.match(r"# ([\w.-]+\.yaml)\b", text):
            (self.folder / name.group(1)).write_text(text, encoding="utf-8")

    def run(self, command, printed):
        if command.startswith(LEFT_OUT):
            return
        if smaller := next((more for begin, more in SMALLER.items() if command.startswith(begin)), None):
            command, printed = f"{command.partition('#')[0]} {smaller}", []
        command = re.sub(r" (docs/examples|models)/", rf" {self.source}/\1/", command)
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, capture_output=True, text=True)
        expected = next((code for begin, code in EXIT_CODES.items() if command.startswith(begin)), 0)
        if done.returncode != expected:
            self.wrong.append(f"{command}\n  exit code {done.returncode}, not {expected}: {done.stderr.strip()}")
        elif not command.startswith(DEPENDS_ON_PIXELS):
            shapes = {shape(line) for line in done.stdout.splitlines()}
            self.wrong += [f"{command}\n  does not print: {line}" for line in printed if shape(line) not in shapes]


def main():
    program, source, page = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3])
    commands = 0
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader(program, source, Path(folder))
        for language, text in blocks_of(source / page):
            if language == "yaml":
                reader.write(text)
            elif not language:
                for command, printed in steps_of(text):
                    commands += 1
                    reader.run(command, printed)
    for what in reader.wrong:
        print(f"{page}: {what}")
    print(f"{commands} commands, {len(reader.wrong)} surprises")
    return 1 if reader.wrong or commands < 5 else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs clang-tidy over the program's sources in the compilation database of build/release, one answer a core.

Tests and benchmarks are left to the compilers: they would double the time.

A file that passed is remembered by the hash of everything that went into the answer (its preprocessed text, its
flags, .clang-tidy and the tool's version), under ~/.cache/rigproof/analysis, and is not analysed again.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATABASE = ROOT / "build/release/compile_commands.json"
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "rigproof/analysis"
TIDY = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
CLANG = shutil.which("clang++-14") or shutil.which("clang++")


def answer_key(entry: dict, salt: bytes) -> str:
    """Hash of all that clang-tidy's answer for this file depends on."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        words = words[1:]
    output = words.index("-o")
    flags = words[1:output] + words[output + 2:]
    flags = [flag for flag in flags if flag != "-c"]
    text = subprocess.run([CLANG, "-E", "-w", *flags], cwd=entry["directory"], capture_output=True, check=False)
    relative_flags = " ".join(flags).replace(str(ROOT), "")
    content = text.stdout.replace(str(ROOT).encode(), b"")
    return hashlib.sha256(salt + relative_flags.encode() + content + text.stderr).hexdigest()


def is_test(name: str) -> bool:
    return os.path.relpath(name, ROOT).split(os.sep)[0] in ("tests", "bench")


def analyse(entry: dict, salt: bytes) -> tuple[str, bool, str]:
    name = os.path.relpath(entry["file"], ROOT)
    stamp = CACHE / answer_key(entry, salt)
    if stamp.exists():
        return name, True, ""
    run = subprocess.run([TIDY, "--quiet", "-p", str(DATABASE.parent), entry["file"]],
                         capture_output=True, text=True, check=False)
    if run.returncode == 0:
        stamp.touch()
        return name, True, ""
    return name, False, run.stdout + run.stderr


def main() -> int:
    if TIDY is None or CLANG is None:
        print("analyse: clang-tidy is missing; scripts/install-dependencies --test installs it", file=sys.stderr)
        return 2
    wanted = {str(pathlib.Path(name).resolve()) for name in sys.argv[1:]}
    entries = [entry for entry in json.loads(DATABASE.read_text())
               if entry["file"].startswith(str(ROOT)) and "/build/" not in entry["file"]
               and (entry["file"] in wanted if wanted else not is_test(entry["file"]))]
    CACHE.mkdir(parents=True, exist_ok=True)
    version = subprocess.run([TIDY, "--version"], capture_output=True, check=False).stdout
    salt = version + (ROOT / ".clang-tidy").read_bytes()
    failures = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, passed, text in pool.map(lambda entry: analyse(entry, salt), entries):
            if not passed:
                failures += 1
                print(f"{name}\n{text}")
    print(f"clang-tidy: {len(entries)} files, {failures} with findings")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

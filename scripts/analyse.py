#!/usr/bin/env python3
"""Runs clang-tidy over the program's sources in the compilation database of build/release, one run a core.

Tests, benchmarks and Python's bindings are left to the compilers: they would double the time.

Most of a run goes into the headers of Eigen and the standard library. So many files of one part of the program are
analysed as one translation unit, without those in which the compiler then sees errors, as their names clash with
another file's: they make a unit of their own. Where that finds anything, the files that are named are analysed without
the others, in the end each by itself: only a finding in a single file counts. What files that pass together hide from
each other: a missing include, and a constant that nothing uses. To look for these, name one file at a time.

A file that passed is remembered by the hash of everything that went into the answer (the text of all files that its
build has read, its flags, .clang-tidy and the tool's version), under ~/.cache/rigproof/analysis, and is not analysed
again. Which files a build has read is in ninja's log: a file that was not built yet is always analysed.
"""
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATABASE = ROOT / "build/release/compile_commands.json"
BATCH = 40
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "rigproof/analysis"
CLANG = shutil.which("clang++-14") or shutil.which("clang++")
TIDY = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")


def is_test(name: str) -> bool:
    return os.path.relpath(name, ROOT).split(os.sep)[0] in ("tests", "bench", "python")


def compile_flags(command: str) -> tuple[list[str], str]:
    """Flags of a compile command, without compiler, files and precompiled headers; and the object that it makes."""
    words = shlex.split(command)
    if os.path.basename(words[0]) == "ccache":
        words = words[1:]
    flags = []
    output = ""
    rest = iter(words[1:])
    for word in rest:
        if word == "-o":
            output = next(rest)
        elif word == "-include":
            next(rest)
        elif word in ("-MT", "-MF"):
            next(rest)
        elif word not in ("-c", "-MD", "-Winvalid-pch", "-fpch-preprocess"):
            flags.append(word)
    return flags[:-1], output


def read_database() -> list[dict]:
    """One entry for each file of the repository that build/release compiles."""
    entries = []
    for entry in json.loads(DATABASE.read_text()):
        if os.path.relpath(entry["file"], ROOT).split(os.sep)[0] in ("build", ".."):
            continue
        flags, entry["output"] = compile_flags(entry.pop("command"))
        entry["arguments"] = [*flags, "-Wzero-as-null-pointer-constant", "-Wsuggest-override"]
        entries.append(entry)
    return entries


def read_dependencies() -> dict[str, list[str]]:
    """Files that each object was compiled from, as the build has noted them."""
    log = subprocess.run(["ninja", "-C", str(DATABASE.parent), "-t", "deps"], capture_output=True, text=True,
                         check=True).stdout
    dependencies = {}
    for line in log.splitlines():
        if line.startswith("    "):
            dependencies[output].append(line.strip())
        elif ": #deps " in line:
            output = line.split(": #deps ")[0]
            dependencies[output] = []
    return dependencies


@functools.lru_cache(None)
def text_hash(name: str) -> bytes:
    return hashlib.sha256(pathlib.Path(name).read_bytes()).digest()


def answer_key(entry: dict, salt: bytes, dependencies: dict[str, list[str]]) -> str:
    """Hash of all that clang-tidy's answer for this file depends on; empty if that is not known."""
    files = set(dependencies.get(entry["output"], []))
    for precompiled in [name for name in files if name.endswith(".gch")]:
        files |= set(dependencies.get(os.path.relpath(os.path.join(DATABASE.parent, precompiled), DATABASE.parent), []))
    paths = [os.path.normpath(os.path.join(DATABASE.parent, name)) for name in files if not name.endswith(".gch")]
    paths.sort(key=lambda path: (path.startswith(str(ROOT)), path))  # the same order wherever the checkout lies
    if not paths or not all(os.path.exists(path) for path in paths):
        return ""
    key = hashlib.sha256(salt + " ".join(entry["arguments"]).replace(str(ROOT), "").encode())
    for path in paths:
        key.update(path.replace(str(ROOT), "").encode() + text_hash(path))
    return key.hexdigest()


def run(tool: list[str], entries: list[dict], check: list[str]) -> subprocess.CompletedProcess:
    """Runs the tool on one file, or on several as if they were one."""
    with tempfile.TemporaryDirectory(prefix="rigproof-analysis-") as folder:
        unit = entries[0]["file"]
        if len(entries) > 1:
            unit = os.path.join(folder, "unit.cpp")
            pathlib.Path(unit).write_text("".join(f'#include "{entry["file"]}"\n' for entry in entries))
        command = [*tool, unit, *check, *joint_flags(entries)]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=DATABASE.parent)


def run_compiler(entries: list[dict]) -> subprocess.CompletedProcess:
    return run([CLANG, "-fsyntax-only", "-ferror-limit=0"], entries, [])


def run_tidy(entries: list[dict]) -> subprocess.CompletedProcess:
    checks = ["--checks=-bugprone-suspicious-include"] if len(entries) > 1 else []
    return run([TIDY, "--quiet", f"--config-file={ROOT / '.clang-tidy'}", *checks], entries, ["--"])


def joint_flags(entries: list[dict]) -> list[str]:
    """Flags of all the files, each once: they find the headers of all."""
    flags = {}
    for entry in entries:
        words = iter(entry["arguments"])
        for word in words:
            flags[(word, next(words)) if word == "-isystem" else (word,)] = None
    return [word for words in flags for word in words]


def part(entries: list[dict], result: subprocess.CompletedProcess) -> tuple[list[dict], list[dict]]:
    """Those without and those with errors in what a tool said; two halves where that does not part them."""
    lines = (result.stdout + result.stderr).splitlines()
    named = {os.path.normpath(line.split(":")[0]) for line in lines if "error: " in line}
    without = [entry for entry in entries if entry["file"] not in named]
    if 0 < len(without) < len(entries):
        return without, [entry for entry in entries if entry["file"] in named]
    return entries[:len(entries) // 2], entries[len(entries) // 2:]


def analyse(entries: list[dict], compiles: bool = False) -> list[tuple[str, str]]:
    """Names and findings of the files that have any; remembers those that have none."""
    if len(entries) > 1 and not compiles:
        result = run_compiler(entries)
        if result.returncode != 0:
            without, rest = part(entries, result)
            return analyse(without, True) + analyse(rest)
    result = run_tidy(entries)
    if result.returncode == 0:
        for entry in entries:
            if entry["key"]:
                (CACHE / entry["key"]).touch()
        return []
    if len(entries) == 1:
        return [(os.path.relpath(entries[0]["file"], ROOT), result.stdout + result.stderr)]
    return [finding for some in part(entries, result) for finding in analyse(some)]


def batches(entries: list[dict]) -> list[list[dict]]:
    """Files of the same part of the program, up to BATCH together, as many in each; the largest first."""
    groups = collections.defaultdict(list)
    for entry in entries:
        groups[os.path.relpath(entry["file"], ROOT).split(os.sep)[0]].append(entry)
    made = []
    for group in groups.values():
        group.sort(key=lambda entry: entry["file"])
        count = -(-len(group) // BATCH)
        made += [group[len(group) * i // count:len(group) * (i + 1) // count] for i in range(count)]
    return sorted(made, key=len, reverse=True)


def main() -> int:
    if TIDY is None or CLANG is None:
        print("analyse: clang-tidy is missing; scripts/install-dependencies --test installs it", file=sys.stderr)
        return 2
    wanted = {str(pathlib.Path(name).resolve()) for name in sys.argv[1:]}
    entries = [entry for entry in read_database()
               if (entry["file"] in wanted if wanted else not is_test(entry["file"]))]
    unknown = wanted - {entry["file"] for entry in entries}
    if unknown:
        print(f"analyse: not compiled by build/release: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    CACHE.mkdir(parents=True, exist_ok=True)
    version = subprocess.run([TIDY, "--version"], capture_output=True, check=False).stdout
    salt = version + (ROOT / ".clang-tidy").read_bytes()
    dependencies = read_dependencies()
    for entry in entries:
        entry["key"] = answer_key(entry, salt, dependencies)
    # A file that is named is analysed in any case: it may have passed only together with others.
    unseen = [entry for entry in entries if wanted or not (entry["key"] and (CACHE / entry["key"]).exists())]
    failures = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for findings in pool.map(analyse, batches(unseen)):
            failures += len(findings)
            for name, text in findings:
                print(f"{name}\n{text}")
    print(f"clang-tidy: {len(entries)} files, {failures} with findings")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

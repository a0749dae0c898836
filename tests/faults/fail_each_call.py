#!/usr/bin/env python3
"""Fails calls to the system, one in each run of a command, and looks at what is left.
Usage: fail_each_call.py PROGRAM LIBRARY [--sample] [--only NAME]... [--kinds LIST] [--errno NAME] [--every N]

PROGRAM is rigproof, LIBRARY is failing_calls.so. Each command is counted through undisturbed; then it runs again for each
call, which fails. --sample tries one call of each kind, as the tests do; without it every call is tried. Required is:
  - the exit code is one of the documented ones, 0 only with all that an undisturbed run writes, and 75 (try again) where
    what failed may pass;
  - one message that names the file of the call that failed, or a folder that it lies in;
  - what was there is as it was, or as an undisturbed run leaves it; nothing temporary remains;
  - the same command, run again, leaves the same bytes as an undisturbed run.
Exits with 1 if any of it fails."""
import argparse
import errno
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

KINDS = ["open", "write", "sync", "rename", "mkdir", "close", "truncate", "copy", "mmap", "fork"]
EXIT_CODES = {0, 2, 75}
REFUSED = 3
TRY_AGAIN = 75
MAY_PASS = {"open", "write", "mkdir", "truncate", "copy", "fork"}  # too many open files, no space, no process
LIMIT_S = 120
# Files that say how long something took, in which every number may differ.
VOLATILE = re.compile(r"(^|/)(times\.csv|counters\.json|packs/[0-9a-f]+\.jsonl|tasks/.*\.json|cache/solutions/.*\.json)$")
# Of a task whose answer is stored, what would have spared the next one work.
SPARED = re.compile(r"swept/cache/solutions/")
# Files that tell how far a command is: whole at any time, and others when it goes on.
GROWING = re.compile(r"(^|/)(run\.yaml|rows\.jsonl|rows\.csv|times\.csv|counters\.json|summary\.[a-z]+|plan\.json|"
                     r"packs/[0-9a-f]+\.jsonl|tasks/.*\.json)$")
GENERATE = ["--set", "name=tiny", "--set", "viewpoints.planner=sampled", "--set", "board.place=scene",
            "--set", "poses=6", "--set", "image_scale=0.25", "-j", "1"]
SWEEP = """mode: geometric
run: {poses: 10}
seeds: 2
methods: [ml, li]
"""


class Case:
    """A command, what runs before it in the same folder, and what an earlier run of it with other settings left."""

    def __init__(self, name, command, before=(), deletes=False, sample=tuple(KINDS), lasts="", removes=()):
        self.name, self.command, self.before = name, command, before
        self.removes = removes  # folders of whole files that the command makes, goes on from, and removes in the end
        self.sample = sample    # kinds of calls that --sample tries, or (kind, at which share of them): few of what takes long
        self.deletes = deletes  # what was there, as it is told to
        self.lasts = lasts      # a new folder of which every file is synced


RUN = ["generate", "-o", "run", "--cache", "cache", *GENERATE]
CALIBRATE = ["calibrate", "run", "-j", "1"]
CASES = [
    Case("generate", ["generate", "-o", "new", "--cache", "new_cache", *GENERATE],
         sample=("write", "sync", "fork")),
    Case("generate_fresh", ["generate", "-o", "run", "--cache", "cache", *GENERATE, "--set", "seed=2", "--fresh"], [RUN],
         deletes=True, sample=(("open", 0.25),)),  # while it removes what was there
    Case("generate_observations", ["generate", "-o", "new", "--cache", "new_cache", "--observations", *GENERATE],
         sample=(("open", 0.61),), removes=("new/recording/", "new/findings/")),  # while it removes what it looked at
    Case("sense", ["sense", "run", "--cache", "cache", "--seed", "7", "-o", "sensed", "-j", "1"], [RUN],
         sample=("open",)),
    Case("observe", ["observe", "run", "-j", "1"], [RUN], sample=("rename",)),
    Case("calibrate", CALIBRATE, [RUN, [*CALIBRATE, "-m", "ml:told=exact,name=ml"]],
         sample=("write", "close")),
    Case("sweep", ["sweep", "start", "sweep.yaml", "-o", "swept", "-j", "1"]),
    Case("sweep_shards", ["sweep", "run", "swept", "-j", "1"],
         [["sweep", "plan", "sweep.yaml", "-o", "swept"]], sample=("fork",)),
    Case("convert", ["convert", "run", "converted", "--to", "memroc"], [RUN], lasts="converted"),
    Case("convert_recording", ["convert", "converted", "recording", "--to", "recording"],
         [RUN, ["convert", "run", "converted", "--to", "memroc"]], lasts="recording"),
    Case("convert_archive", ["convert", "run", "packed", "--to", "archive"], [RUN], sample=("sync",), lasts="packed"),
    Case("convert_bag", ["convert", "run", "run.mcap"], [RUN]),
    Case("init", ["init", "run.mcap", "-o", "made", "-j", "1"], [RUN, ["convert", "run", "run.mcap"]], sample=("rename",),
         lasts="made"),
    Case("bench_export", ["bench", "export", "run", "--to", "mrcal", "-o", "case"], [RUN], sample=("sync",)),
    Case("inspect", ["inspect", "run", "-o", "looked"], [RUN, CALIBRATE], sample=()),
    Case("board", ["board", "checkerboard_5x4_100mm", "-o", "board.pdf"], sample=()),
    Case("export", ["export", "run/results", "--to", "urdf", "-o", "robot.urdf"], [RUN, CALIBRATE], sample=()),
    Case("export_again", ["export", "run/results", "--to", "kalibr", "-o", "robot.txt"],
         [RUN, CALIBRATE, ["export", "run/results", "--to", "urdf", "-o", "robot.txt"]]),
    Case("report", ["report", "run", "-j", "1"], [RUN, CALIBRATE], sample=("rename",)),
]


class Bench:
    """Runs commands in copies of prepared folders."""

    def __init__(self, program, library, scratch):
        self.program, self.library, self.scratch = program, library, scratch
        self.prepared = {}

    def run(self, command, folder, at=0, kinds="", error=0):
        """-> exit code, standard error, state"""
        temporary, state = self.scratch / "tmp", self.scratch / "state"
        temporary.mkdir(exist_ok=True)
        state.unlink(missing_ok=True)
        environment = {name: value for name, value in os.environ.items() if not name.startswith("RIGPROOF")}
        environment.update(LD_PRELOAD=str(self.library), TMPDIR=str(temporary), FAILING_CALLS=str(state),
                           FAILING_CALLS_AT=str(at), LC_ALL="C.UTF-8")
        if kinds:
            environment["FAILING_CALLS_KINDS"] = kinds
        if error:
            environment["FAILING_CALLS_ERRNO"] = str(error)
        try:
            done = subprocess.run([self.program, *command], cwd=folder, env=environment, capture_output=True,
                                  timeout=LIMIT_S, check=False)
            code, said = done.returncode, done.stderr.decode(errors="replace")
        except subprocess.TimeoutExpired:
            code, said = "it hangs", ""
        return code, said, State(state)

    def folder_before(self, case):
        """The folder in which the case starts, made once for all cases that begin alike."""
        key = repr(case.before)
        if key not in self.prepared:
            folder = self.scratch / f"before{len(self.prepared)}"
            folder.mkdir()
            (folder / "sweep.yaml").write_text(SWEEP)
            for command in case.before:
                code, said, _ = self.run(command, folder)
                if code not in (0, REFUSED):
                    sys.exit(f"{' '.join(command)}: exit code {code}: {said}")
            self.prepared[key] = folder
        return self.prepared[key]

    def copy_before(self, case):
        folder = self.scratch / "trial"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.folder_before(case), folder, symlinks=True)
        return folder

    def left_in_tmp(self):
        left = [path.name for path in (self.scratch / "tmp").iterdir()]
        shutil.rmtree(self.scratch / "tmp")
        return left


class State:
    """What failing_calls.so counted."""

    def __init__(self, file):
        data = file.read_bytes()
        numbers = struct.unpack_from("<11q", data)
        self.total, self.of_kind = numbers[0], dict(zip(KINDS, numbers[1:]))
        kind = struct.unpack_from("<i", data, 88)[0]
        self.failed = KINDS[kind - 1] if kind else ""
        self.path = data[92:].split(b"\0")[0].decode()


def tree(folder):
    """Content of all files by relative path; folders end in a slash."""
    content = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            content[str(path.relative_to(folder))] = path.read_bytes()
        elif path.is_dir():
            content[str(path.relative_to(folder)) + "/"] = b""
    return content


RENDER_HEADER = struct.Struct("<8s10I")


def decoded_render(data):
    """What a file of the cache of renders holds (generator/src/clean_cache.cpp); the bytes themselves where it is
    damaged. For the same pixels ISA-L writes other bytes once in some thousand runs."""
    try:
        *header, name, color, depth, imager, checksum = RENDER_HEADER.unpack_from(data)
        if checksum != zlib.crc32(data[RENDER_HEADER.size:]):
            return data
        places = [RENDER_HEADER.size]
        for size in (name, color, depth, imager):
            places.append(places[-1] + size)
        planes, at = [], places[2]
        while at < places[3]:
            size = struct.unpack_from("<I", data, at)[0]
            plane = data[at + 4:at + 4 + size]
            planes.append(plane if size == header[4] * header[5] else zlib.decompress(plane, -15))
            at += 4 + size
        return (header, data[places[0]:places[1]], zlib.decompress(data[places[1]:places[2]], -15), planes,
                zlib.decompress(data[places[3]:], -15) if imager else b"")
    except (struct.error, zlib.error):
        return data


def is_same(name, found, expected):
    return found == expected or (name.endswith(".clean") and found is not None and expected is not None
                                 and decoded_render(found) == decoded_render(expected))


def is_temporary(path):
    return any(part.endswith((".tmp", ".partial")) for part in path.rstrip("/").split("/"))


def differences(found, expected):
    names = [name for name in sorted(set(found) | set(expected))
             if not SPARED.match(name) and not VOLATILE.search(name)
             and not is_same(name, found.get(name), expected.get(name))]
    return [("missing " if name not in found else "too many " if name not in expected else "other ") + name
            for name in names]


def problems_of_files(now, before, after, case):
    problems = [f"left behind: {name}" for name in now if is_temporary(name)]
    for name, content in before.items():
        if name not in now:
            if name in after and not case.deletes:
                problems.append(f"lost: {name}")
        elif not any(is_same(name, now[name], one) for one in (content, after.get(name))) and not GROWING.search(name):
            problems.append(f"neither old nor new: {name}")
    for name, content in now.items():
        if name in before or name.endswith("/") or is_temporary(name) or GROWING.search(name):
            continue
        if name.startswith(case.removes):
            continue
        if name not in after or not is_same(name, content, after[name]) and not VOLATILE.search(name):
            problems.append(f"half-written: {name}")
    return problems


def is_named(said, path):
    """Whether the message names the file, or a folder that it lies in; temporary names begin with a dot."""
    parts = [re.sub(r"^\.(.+?)\.\d+\.\d+\.\d+\.tmp$", r"\1", part).replace(".partial", "") for part in path.split("/")]
    return path == "." or any(part and part in said for part in parts[-2:])  # "." is above all that is named


def problems_of_message(code, said, state, forced_error):
    if code not in EXIT_CODES:
        return [f"exit code {code}"]
    if code == 0:
        return []
    if code != TRY_AGAIN and state.failed in MAY_PASS and not forced_error:
        return [f"exit code {code} of what may pass"]
    errors = [line for line in said.splitlines() if line.startswith("rigproof: ")]
    if len(errors) != 1:
        return [f"{len(errors)} messages"]
    if state.path and not is_named(errors[0], state.path):
        return ["the message does not name the file"]
    return []


def try_call(bench, case, after, at, kinds, error):
    """-> what is wrong, in words; the state"""
    folder = bench.copy_before(case)
    before = tree(folder)
    code, said, state = bench.run(case.command, folder, at, kinds, error)
    if not state.failed:
        return [], said, state  # other threads were faster this time: fewer calls
    now = tree(folder)
    problems = problems_of_message(code, said, state, error)
    problems += problems_of_files(now, before, after, case)
    problems += [f"left in the temporary folder: {name}" for name in bench.left_in_tmp()]
    told = f"exit code {code}: {said.strip()}"
    if code == 0:
        return problems + ["good, but " + what for what in differences(now, after)], told, state
    again, said_again, _ = bench.run(case.command, folder)
    bench.left_in_tmp()
    if again != 0:
        problems.append(f"then, undisturbed: exit code {again}: {said_again.strip()}")
    else:
        problems += ["then, undisturbed: " + what for what in differences(tree(folder), after)]
    return problems, told, state


def calls_to_try(case, state, arguments):
    """(kinds, number of the call) of each."""
    kinds = arguments.kinds.split(",") if arguments.kinds else case.sample if arguments.sample else KINDS
    for kind, share in [kind if isinstance(kind, tuple) else (kind, 0.5) for kind in kinds]:
        count = state.of_kind[kind]
        if arguments.sample and count:
            yield kind, int(share * count + 0.5) or 1
        elif not arguments.sample:
            for at in range(1, count + 1, arguments.every):
                yield kind, at


def is_durable(case, after, state):
    """Whether there were more syncs than the new folder has files: its folders, and its name, are synced as well."""
    return state.of_kind["sync"] > sum(name.startswith(case.lasts + "/") for name in after if not name.endswith("/"))


def try_case(bench, case, arguments):
    """-> number of tries, number of tries with problems"""
    folder = bench.copy_before(case)
    code, said, state = bench.run(case.command, folder)
    if code != 0:
        sys.exit(f"{case.name}: undisturbed: exit code {code}: {said}")
    bench.left_in_tmp()
    after = tree(folder)
    tries = bad = good = 0
    if case.lasts and not is_durable(case, after, state):
        print(f"{case.name}: {state.of_kind['sync']} syncs are fewer than its files")
        bad += 1
    error = getattr(errno, arguments.errno) if arguments.errno else 0
    for kind, at in calls_to_try(case, state, arguments):
        problems, told, failed = try_call(bench, case, after, at, kind, error)
        tries += 1
        good += told.startswith("exit code 0")
        if problems:
            bad += 1
            print(f"{case.name}: {kind} {at} of {state.of_kind[kind]} ({failed.path or 'no file'}): {told}")
            print("".join(f"    {problem}\n" for problem in problems[:8]), end="", flush=True)
    print(f"{case.name}: {tries} calls failed in turn, {good} made no difference, {bad} with problems", flush=True)
    return tries, bad


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("library", type=Path)
    parser.add_argument("--sample", action="store_true")
    parser.add_argument("--only", action="append", choices=[case.name for case in CASES])
    parser.add_argument("--kinds")
    parser.add_argument("--errno")
    parser.add_argument("--every", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rigproof-faults-") as scratch:
        bench = Bench(arguments.program.resolve(), arguments.library.resolve(), Path(scratch))
        results = [try_case(bench, case, arguments) for case in CASES
                   if case.name in (arguments.only or [case.name]) and (case.sample or not arguments.sample)]
    bad = sum(result[1] for result in results)
    print(f"{sum(result[0] for result in results)} calls, {bad} with problems")
    return 1 if bad or not results else 0


if __name__ == "__main__":
    sys.exit(main())

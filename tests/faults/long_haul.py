#!/usr/bin/env python3
"""Renders and senses many small frames, each in one long command, and watches what its processes hold meanwhile.
Usage: long_haul.py PROGRAM [--frames N]

Fails if
  - a process grows by a tenth of a depth picture, or more, for each frame: names and poses take less, a kept picture more;
  - a process has more descriptors open at any time of the second half of the frames than it ever has in the first;
  - the temporary folder is not empty at the end, or a temporary or partial file lies among what was written.
Prints the growth for 10,000 frames. Growth is the slope of anonymous and shared memory over the frames that are written,
without the first third, in which caches and pools fill."""
import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SCALE = 0.1
GROWTH_LIMIT_BYTES = 128 * 72 * 2 // 10  # of a depth picture of husky_1x_d455's camera at that scale
INTERVAL_S = 0.02


def tree(pid):
    """The process and all below it."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [pid] + [below for child in children for below in tree(int(child))]


def held(pid):
    """-> bytes of memory that are no file's, descriptors; None of a process that has ended"""
    try:
        status = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        memory = sum(1024 * int(status[key].split()[0]) for key in ("RssAnon", "RssShmem"))
        return memory, len(os.listdir(f"/proc/{pid}/fd"))
    except (OSError, KeyError):
        return None


def written(folder):
    try:
        return len(os.listdir(folder / "recording/front/depth"))
    except FileNotFoundError:
        return 0


def watch(command, folder, temporary):
    """Runs the command -> rows of (frames written, bytes, descriptors) by process."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("RIGPROOF")}
    samples = {}
    with subprocess.Popen(command, env={**environment, "TMPDIR": str(temporary)}, stderr=subprocess.PIPE) as process:
        while process.poll() is None:
            frames = written(folder)
            for pid in tree(process.pid):
                if (now := held(pid)) is not None:
                    samples.setdefault(pid, []).append((frames, *now))
            time.sleep(INTERVAL_S)
        said = process.stderr.read().decode(errors="replace")
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {process.returncode}: {said}")
    return samples


def problems_of_samples(name, samples, frames):
    """Prints each process's growth -> what is wrong, in words"""
    problems, judged = [], 0
    for rows in map(np.array, samples.values()):
        rows = rows[(rows[:, 0] > frames / 3) & (rows[:, 0] < frames)]
        if len(np.unique(rows[:, 0])) < 5 or np.ptp(rows[:, 0]) < frames / 3:
            continue  # it waits for another, or ended early
        judged += 1
        slope = np.polyfit(rows[:, 0], rows[:, 1], 1)[0]
        early, late = rows[rows[:, 0] <= frames / 2], rows[rows[:, 0] > frames / 2]
        print(f"{name}: {len(rows)} samples, {rows[-1, 1] / 1e6:.1f} MB at the end, {slope * 1e4 / 1e6:+.2f} MB for 10,000 "
              f"frames, {rows[:, 2].min()} to {rows[:, 2].max()} descriptors", flush=True)
        if slope >= GROWTH_LIMIT_BYTES:
            problems.append(f"{name}: memory grows by {slope:.0f} bytes a frame; allowed is less than {GROWTH_LIMIT_BYTES}")
        if late[:, 2].min() > early[:, 2].max():
            problems.append(f"{name}: {late[:, 2].min()} descriptors or more in the second half, "
                            f"{early[:, 2].max()} or fewer in the first")
    return problems if judged else [f"{name}: no process was seen over a third of the frames; take more of them"]


def problems_of_files(scratch):
    left = [str(path.relative_to(scratch)) for path in scratch.rglob("*")
            if path.name.endswith((".tmp", ".partial")) or path.parent == scratch / "tmp"]
    return [f"left behind: {name}" for name in left]


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--frames", type=int, default=1500)
    arguments = parser.parse_args()
    problems = []
    with tempfile.TemporaryDirectory(prefix="rigproof-long-haul-") as folder:
        scratch = Path(folder)
        (scratch / "tmp").mkdir()
        run, sensed, cache = scratch / "run", scratch / "sensed", scratch / "cache"
        settings = ["name=long", "rig=husky_1x_d455", "viewpoints.planner=sampled", "board.place=scene",
                    f"image_scale={SCALE}", f"poses={arguments.frames}"]
        generate = ["generate", "-o", run, "--cache", cache, "-j", "1", "-q"]
        generate += [part for setting in settings for part in ("--set", setting)]
        sense = ["sense", run, "--cache", cache, "--seed", "7", "-o", sensed, "-j", "1", "-q"]
        for command, output in ((generate, run), (sense, sensed)):
            samples = watch([arguments.program.resolve(), *command], output, scratch / "tmp")
            if written(output) < arguments.frames:
                problems.append(f"{command[0]}: {written(output)} frames of {arguments.frames}")
            problems += problems_of_samples(command[0], samples, written(output))
        problems += problems_of_files(scratch)
    print("\n".join(problems) or "nothing grows, nothing is left")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

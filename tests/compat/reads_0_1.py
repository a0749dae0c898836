#!/usr/bin/env python3
"""What version 0.1 wrote and what was written for it, in 0.1/: configurations that it shipped, a run without its images, a
sweep, a plan, and what it printed as JSON (says/). Made by its program, commit de74902; nothing in it is edited.
Usage: reads_0_1.py PROGRAM [unittest's arguments]"""
import csv
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
OLD = Path(__file__).parent / "0.1"


def run(*arguments, folder=None):
    """In `folder`, from which a configuration names its rig."""
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False)


def rigproof(*arguments, codes=(0,), folder=None):
    done = run(*arguments, folder=folder)
    if done.returncode not in codes:
        raise AssertionError(f"rigproof {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def said(name):
    return json.loads((OLD / "says" / f"{name}.json").read_text(encoding="utf-8"))


def keys_of(value, path=""):
    """Paths of all keys; elements of a list count as one."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield f"{path}.{key}"
            yield from keys_of(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for inner in value:
            yield from keys_of(inner, f"{path}[]")


def numbers_of(value, wanted, path=""):
    """(path, number) of all numbers below keys that are `wanted`."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers_of(inner, wanted, f"{path}.{key}")
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from numbers_of(inner, wanted, f"{path}[{i}]")
    elif isinstance(value, float) and any(f".{key}" in path for key in wanted):
        yield path, value


def options_of(command):
    return set(re.findall(r"^  (?:-\w,)?(--[a-z][a-z-]*)", rigproof(*command.split(), "--help"), re.M))


class Reads(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name) / "0.1"
        shutil.copytree(OLD, self.folder)

    def says_what_it_said(self, name, text):
        now = json.loads(text)
        self.assertEqual(sorted(set(keys_of(said(name))) - set(keys_of(now))), [], "keys that are no longer there")
        return now

    def test_validate_judges_its_results_alike(self):
        now = self.says_what_it_said("validate", rigproof("validate", self.folder / "run", "--json"))
        wanted = ("error_m_rad", "sigma_m_rad", "z", "roll_pitch_yaw_error_rad")
        before, after = (dict(numbers_of(answer["results"], wanted)) for answer in (said("validate"), now))
        self.assertGreater(len(before), 100)
        self.assertEqual(before.keys(), after.keys())
        for path, number in before.items():
            self.assertAlmostEqual(number, after[path], delta=1e-9 * max(1.0, abs(number)), msg=path)

    def test_its_observations_have_the_same_answer(self):
        out = self.folder / "out"
        rigproof("calibrate", self.folder / "run/observations.json", "-m", "joint_memroc", "-o", out)
        shutil.copy(out / "joint_memroc.yaml", self.folder / "run/results/again.yaml")
        answers = json.loads(rigproof("validate", self.folder / "run", self.folder / "run/results/joint_memroc.yaml",
                                      self.folder / "run/results/again.yaml", "--json"))["results"]
        before, after = (dict(numbers_of(answer["camera_to_robot"], ("error_m_rad",))) for answer in answers)
        self.assertEqual(len(before), 12)
        for path, number in before.items():
            self.assertAlmostEqual(number, after[path], delta=1e-9, msg=path)

    def test_calibrate_says_at_least_what_it_said(self):
        self.says_what_it_said("calibrate", rigproof("calibrate", self.folder / "run/observations.json", "-o",
                                                     self.folder / "out", "--accept",
                                                     self.folder / "config/accept/default.yaml", "--json", codes=(0, 1)))

    def test_its_result_and_observations_are_compared_and_added_to(self):
        run = self.folder / "run"
        moved = rigproof("moved", run / "observations.json", run / "results/ml.yaml", "--json")
        self.says_what_it_said("moved", moved)
        self.says_what_it_said("suggest", rigproof("suggest", run / "observations.json", "--json"))
        self.says_what_it_said("methods", rigproof("methods", "--json"))

    def test_its_result_is_exported_and_reported(self):
        run = self.folder / "run"
        self.assertIn("left", rigproof("export", run / "results/ml.yaml", "--to", "json"))
        rigproof("report", run, "-o", self.folder / "report.html")
        self.assertGreater((self.folder / "report.html").stat().st_size, 100000)

    def test_its_limits_are_read(self):
        for name in ("ci", "honest", "paper"):
            rigproof("validate", self.folder / "run", "--budget", self.folder / f"config/budgets/{name}.yaml", codes=(0, 1))

    def test_its_sweep_is_summarised_and_goes_on(self):
        sweep = self.folder / "sweep"
        rigproof("sweep", "status", sweep)
        rigproof("sweep", "summary", sweep)
        before, after = (list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
                         for file in (OLD / "says/summary.csv", sweep / "summary.csv"))
        row_of = {(row["lambda"], row["method"], row["subject"], row["axis"]): row for row in after}
        self.assertGreater(len(before), 20)
        for row in before:
            now = row_of[row["lambda"], row["method"], row["subject"], row["axis"]]
            for column in ("success_rate", "mean_abs", "rmse"):
                if row[column]:
                    self.assertAlmostEqual(float(now[column]), float(row[column]), places=9, msg=column)
        rigproof("report", sweep, "-o", self.folder / "sweep.html")
        rigproof("sweep", "start", sweep / "sweep.yaml", "-o", sweep)

    def test_its_configurations_are_read(self):
        def refusal(file):
            is_sweep = re.search(r"^(methods|axes):", file.read_text(encoding="utf-8"), re.M)
            plan = self.folder / "plans" / file.stem / file.parent.name
            few = () if "planner: list" in file.read_text(encoding="utf-8") else ("--set", "poses=1")
            command = ("sweep", "plan", file, "-o", plan) if is_sweep else ("generate", file, "--dry-run", *few)
            done = run(*command, "-q", folder=self.folder)
            return done.stderr if done.returncode != 0 else ""

        folders = ("config", "config/paper", "config/bench-v1", "config/stress", "config/sweeps")
        files = [self.folder / "run.yaml", self.folder / "suggested.yaml",
                 *(file for name in folders for file in sorted((self.folder / name).glob("*.yaml")))]
        self.assertGreater(len(files), 40)
        with ThreadPoolExecutor() as threads:
            self.assertEqual([said for said in threads.map(refusal, files) if said], [])

    def test_what_chose_headings_still_draws_as_it_says(self):
        config = self.folder / "run.yaml"
        config.write_text(config.read_text() + "viewpoints: {heading_deg: 0, all_cameras_share: 1}\n")
        self.assertIn("12 stops", rigproof("generate", config, "--dry-run", folder=self.folder))
        config.write_text(config.read_text().replace("{heading", "{planner: covering, heading"))
        done = run("generate", config, "--dry-run", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("viewpoints.heading_deg: 0: belongs to planner sampled", done.stderr)

    def test_its_commands_and_options_are_taken(self):
        for command, options in said("options").items():
            self.assertEqual(sorted(set(options) - options_of(command)), [], command)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])

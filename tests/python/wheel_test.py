#!/usr/bin/env python3
"""The wheel of a build: the same bytes twice, installed without a network into a virtual environment and into a folder,
with its own data, and good for all of package_test.py.
Usage: wheel_test.py BUILD_FOLDER PROGRAM; exit code 77 where this Python has no pip."""
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
BUILD, PROGRAM = Path(sys.argv[1]), Path(sys.argv[2])
KNOWN = """import rigproof
try:
    rigproof.generate("none_of_this_name", "never")
except rigproof.Error as error:
    print(error)
"""


def run(*command, path=None):
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    if path:
        environment["PYTHONPATH"] = str(path)
    return subprocess.run([str(part) for part in command], env=environment, capture_output=True, text=True, check=False)


class Wheel(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.scratch = Path(scratch.name)
        self.wheel = self.made("first")

    def made(self, folder):
        out = run(TOP / "scripts/wheel", BUILD, "-o", self.scratch / folder)
        self.assertEqual(out.returncode, 0, out.stderr)
        return Path(out.stdout.strip())

    def pip(self, python, *arguments):
        out = run(python, "-m", "pip", "install", "--no-index", "--no-cache-dir", "--disable-pip-version-check", *arguments)
        self.assertEqual(out.returncode, 0, out.stdout + out.stderr)

    def test_same_bytes_and_all_of_the_package_from_a_folder(self):
        self.assertEqual(self.wheel.read_bytes(), self.made("second").read_bytes())
        target = self.scratch / "target"
        self.pip(sys.executable, "--no-deps", "--target", target, self.wheel)
        out = run(sys.executable, TOP / "tests/python/package_test.py", PROGRAM, TOP / "python/rigproof/__init__.pyi",
                  path=target)
        self.assertEqual(out.returncode, 0, out.stderr)

    def test_a_virtual_environment_has_its_own_data(self):
        environment = self.scratch / "venv"
        made = run(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", environment)
        self.assertEqual(made.returncode, 0, made.stderr)
        python = environment / "bin/python"
        self.pip(python, self.wheel)
        config = environment / "share/rigproof/config"
        (config / "demo.yaml").rename(config / "only_of_this_wheel.yaml")
        self.assertIn("only_of_this_wheel", run(python, "-c", KNOWN).stdout)
        gone = run(python, "-m", "pip", "uninstall", "-y", "rigproof")
        self.assertEqual(gone.returncode, 0, gone.stderr)
        self.assertNotEqual(run(python, "-c", "import rigproof").returncode, 0)

    def test_a_folder_without_a_package_is_refused(self):
        out = run(TOP / "scripts/wheel", self.scratch)
        self.assertEqual(out.returncode, 2)
        self.assertIn(str(self.scratch / "python/rigproof"), out.stderr)


if __name__ == "__main__":
    if importlib.util.find_spec("pip") is None:
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

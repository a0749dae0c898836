#!/usr/bin/env python3
"""The Python package: the command line's numbers to the bit, its errors, and arrays that are wrong.
Usage: package_test.py PROGRAM STUB [unittest's arguments]; PYTHONPATH leads to the package."""
import ast
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import rigproof

PROGRAM, STUB = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def command(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


class SameAsTheCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name) / "run"
        cls.observations, cls.truth = rigproof.draw(seed=4, stops=15)
        (cls.folder / "truth").mkdir(parents=True)
        (cls.folder / "run.yaml").write_text("{}\n")
        cls.observations.save(cls.folder / "observations.json")
        cls.truth.save(cls.folder / "truth/truth.yaml")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_a_result_has_the_same_bytes(self):
        for method in ("ml", "joint_memroc"):
            out = command("calibrate", self.folder / "observations.json", "-m", method, "--json")
            self.assertEqual(out.returncode, 0, out.stderr)
            result = rigproof.calibrate(self.folder, method=method)
            result.save(self.folder / "ours.yaml")
            self.assertEqual((self.folder / "ours.yaml").read_bytes(),
                             (self.folder / f"results/{method}.yaml").read_bytes())
            for theirs, ours in zip(json.loads(out.stdout)["results"][0]["camera_to_robot"], result.camera_to_robot):
                self.assertEqual(theirs["translation_m"], list(ours.T_parent_child.translation_m))
                self.assertEqual(theirs["quaternion_xyzw"], list(ours.T_parent_child.quaternion_xyzw))
                if "sigma" in theirs:
                    told = theirs["sigma"]
                    self.assertEqual([told[axis] for axis in ("tx_m", "ty_m", "tz_m", "rx_rad", "ry_rad", "rz_rad")],
                                     list(ours.sigma))

    def test_a_validation_has_the_same_numbers_and_words(self):
        result = rigproof.calibrate(self.observations)
        result.save(self.folder / "ours.yaml")
        out = command("validate", self.folder, self.folder / "ours.yaml", "--json", "--budget", "ci")
        theirs = json.loads(out.stdout)["results"][0]
        ours = rigproof.validate(rigproof.Result.load(self.folder / "ours.yaml"), self.truth, "ci")
        self.assertEqual(theirs["passed"], ours.passed)
        self.assertEqual(len(theirs["checks"]), len(ours.checks))
        for told, error in zip(theirs["camera_to_robot"], ours.camera_to_robot):
            self.assertEqual(told["error_m_rad"], list(error.error))
            self.assertEqual(told["sigma_m_rad"], list(error.sigma))
            self.assertEqual(told["z"], list(error.z))
        self.assertEqual(theirs["nees"]["all"], ours.nees)
        text = command("validate", self.folder, self.folder / "ours.yaml").stdout
        self.assertTrue(text.startswith(str(rigproof.validate(result, self.truth)).replace("ml against", "ours.yaml against")))

    def test_a_result_has_the_point_about_which_the_robot_was_said_to_turn(self):
        file = self.folder / "turning.yaml"
        result = rigproof.calibrate(self.observations)
        self.assertIsNone(result.rotation_centre_sigma_m)
        result.save(file)
        file.write_text(file.read_text() + "rotation_centre_mm: [130, -20]\nrotation_centre_sigma_mm: 15\n")
        stated = rigproof.Result.load(file)
        np.testing.assert_array_equal(stated.rotation_centre_m, [0.13, -0.02])
        self.assertEqual(stated.rotation_centre_sigma_m, 0.015)

    def test_what_is_read_is_what_was_written(self):
        opened = rigproof.open(self.folder)
        self.assertEqual(opened.observations.to_json(), self.observations.to_json())
        for name, pose in opened.truth.poses.items():  # what was written is normalised again
            np.testing.assert_allclose(pose.matrix, self.truth.poses[name].matrix, atol=1e-15)
        self.assertIsNone(opened.recording)
        self.assertEqual(opened.observations.odometry.shape, (15, 3))
        self.assertEqual(opened.observations.accelerations.shape, (15, 3))
        self.assertFalse(opened.observations.accelerations.any())
        self.assertEqual(opened.observations.stamps_s.shape, (15,))

    def test_errors_are_those_of_the_command(self):
        broken = self.folder / "broken.json"
        for text in ("", "{", '{"format": 3}', "\x00\xff"):
            broken.write_text(text, encoding="latin-1")
            for read in (rigproof.Observations.load, rigproof.open, rigproof.calibrate):
                with self.assertRaises(rigproof.Error) as caught:
                    read(broken)
                self.assertEqual(caught.exception.exit_code, 2)
            self.assertEqual(command("calibrate", broken).stderr, f"rigproof: {caught.exception}\n")
        for call in (lambda: rigproof.open("nowhere"), lambda: rigproof.Truth.load(self.folder),
                     lambda: rigproof.calibrate(self.observations, method="joint_memrok"),
                     lambda: self.observations.save("/proc/nowhere/observations.json")):
            with self.assertRaises(rigproof.Error):
                call()

    def test_the_bound_is_below_the_sigmas(self):
        bounds = rigproof.bound(self.observations, self.truth)
        sigmas = rigproof.calibrate(self.observations).camera_to_robot[0].sigma
        self.assertEqual((bounds[0]["parent"], bounds[0]["child"]), ("robot", self.truth.cameras[0].name))
        # A sigma is evaluated at the estimate, with a noise that is estimated, too.
        np.testing.assert_array_less(bounds[0]["sigma"], 1.5 * sigmas)


class Geometry(unittest.TestCase):
    camera = rigproof.Camera(1280, 720, 640, 641, 639.5, 359.5, "brown_conrady", [-0.1, 0.01, 1e-3, -1e-3, 0.0])
    points = np.array([[0.1, -0.2, 1.5], [0.4, 0.3, 2.0], [-0.5, 0.1, 3.0]])

    def test_jacobians_are_the_derivatives(self):
        pixels, jacobians = self.camera.project(self.points, jacobians=True)
        step = 1e-6
        for axis in range(3):
            moved = np.zeros(3)
            moved[axis] = step
            slope = (self.camera.project(self.points + moved) - self.camera.project(self.points - moved)) / (2 * step)
            np.testing.assert_allclose(jacobians[:, :, axis], slope, atol=1e-5)  # px/m; rounding of 1e-13 m / step
        rays = self.camera.unproject(pixels)
        np.testing.assert_allclose(rays * self.points[:, 2:], self.points, atol=1e-9)  # its iteration ends there

    def test_what_has_no_pixel_is_nan(self):
        pixels, jacobians = self.camera.project([[0, 0, -1], [np.nan, 0, 1], [0, 0, 1]], jacobians=True)
        self.assertEqual(np.isnan(pixels).all(axis=1).tolist(), [True, True, False])
        self.assertTrue(np.isnan(jacobians[:2]).all())
        self.assertTrue(np.isnan(self.camera.unproject([[np.nan, 1]])).all())
        self.assertEqual(self.camera.project(np.zeros((0, 3))).shape, (0, 2))

    def test_any_layout_of_an_array_counts(self):
        wide = np.zeros((3, 9))
        wide[:, ::3] = self.points
        for same in (wide[:, ::3], np.asfortranarray(self.points), self.points.tolist()):
            np.testing.assert_array_equal(self.camera.project(same), self.camera.project(self.points))
        whole = np.array([[1, 2, 4]], dtype=np.int16)
        np.testing.assert_array_equal(self.camera.project(whole), self.camera.project(whole.astype(float)))

    def test_wrong_shapes_and_types_are_told(self):
        pose = rigproof.Pose()
        for call, told in ((lambda: self.camera.project(np.zeros(3)), r"points_camera_m: has the shape \(3,\)"),
                           (lambda: self.camera.project(None), r"has the shape \(\)"),
                           (lambda: self.camera.project(np.zeros((2, 3, 3))), r"allowed is \(n, 3\)"),
                           (lambda: self.camera.unproject(np.zeros((4, 3))), "pixels"),
                           (lambda: rigproof.Pose(np.zeros((4, 4))), "no rigid transform"),
                           (lambda: rigproof.Pose(np.full((4, 4), np.nan)), "NaN"),
                           (lambda: rigproof.Pose.from_quaternion([0, 0, 0], [1, 1, 1, 1]), "length 2"),
                           (lambda: pose @ np.zeros((3, 4)), "points"),
                           (lambda: rigproof.nees([pose], [], np.eye(6)), "1 and 0 poses"),
                           (lambda: rigproof.nees([pose], [pose], np.eye(5)), r"\(6, 6\)"),
                           (lambda: rigproof.nees([pose], [pose], -np.eye(6)), "no covariance"),
                           (lambda: rigproof.Camera(0, 1, 1, 1, 0, 0), "positive"),
                           (lambda: rigproof.Camera(9, 9, 1, 1, 0, 0, "fisheye"), "kannala_brandt"),
                           (lambda: rigproof.Camera(9, 9, 1, 1, 0, 0, "pinhole", [1.0]), "pinhole has 0"),
                           (lambda: rigproof.draw(stops=-1), "stops")):
            with self.assertRaisesRegex(ValueError, told):
                call()
        for call in (lambda: self.camera.project("no"), lambda: pose @ "no",
                     lambda: rigproof.Pose("no"), lambda: rigproof.calibrate(3), lambda: rigproof.open(3),
                     lambda: rigproof.validate(1, 2), lambda: setattr(self.camera, "fx_px", 1.0)):
            with self.assertRaises((TypeError, AttributeError)):
                call()

    def test_poses_compose_and_come_back(self):
        T = rigproof.Pose.exp([0.1, 0.2, 0.3, 0.4, -0.5, 0.6])
        np.testing.assert_allclose((T @ T.inverse()).matrix, np.eye(4), atol=1e-15)
        np.testing.assert_allclose(T @ self.points, self.points @ T.rotation.T + T.translation_m, atol=1e-15)
        np.testing.assert_allclose(T.log(), [0.1, 0.2, 0.3, 0.4, -0.5, 0.6], atol=1e-15)
        error = [0.01, 0.02, -0.01, 0.001, 0.002, 0.003]
        np.testing.assert_allclose(rigproof.transform_error(rigproof.apply_transform_error(T, error), T), error,
                                   atol=1e-15)
        self.assertEqual(pickle.loads(pickle.dumps(T)), T)
        camera = pickle.loads(pickle.dumps(self.camera))
        np.testing.assert_array_equal(camera.project(self.points), self.camera.project(self.points))


class OwnMethods(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.observations, cls.truth = rigproof.draw(seed=1, stops=8)

    def test_a_function_answers_poses(self):
        def oracle(observations):
            self.assertEqual(len(observations.cameras), 3)
            return {name: pose.matrix for name, pose in self.truth.poses.items()}
        result = rigproof.calibrate(self.observations, method=oracle)
        self.assertEqual((result.method, result.status), ("oracle", "solved"))
        errors = rigproof.validate(result, self.truth).camera_to_robot
        np.testing.assert_allclose([e.error for e in errors], 0.0, atol=1e-12)  # a matrix's rounding

    def test_what_is_left_out_is_told(self):
        name, pose = next(iter(self.truth.poses.items()))
        result = rigproof.calibrate(self.observations, method=lambda o: {name: pose})
        self.assertEqual((result.status, len(result.reasons)), ("partial", 2))
        result = rigproof.calibrate(self.observations, method=lambda o: rigproof.Result.refused("x", "It rained."))
        self.assertEqual((result.status, str(result.reasons[0])), ("refused", "It rained."))

    def test_several_boards_go_to_functions_that_say_so(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "observations.json"
            self.observations.save(file)
            told = json.loads(file.read_text())
            marked = {**told["board"], "type": "charuco", "marker_mm": 60}
            told["board"] = {**marked, "dictionary": "DICT_4X4_50"}
            told["more_boards"] = [{**marked, "dictionary": "DICT_5X5_50"}]
            file.write_text(json.dumps(told))
            def oracle(observations):
                self.assertEqual(len(observations.more_boards), 1)
                return self.truth.poses
            result = rigproof.calibrate(file, method=oracle)
            self.assertEqual((result.status, result.reasons[0].code), ("refused", "method.one_board"))
            oracle.several_boards = True
            self.assertEqual(rigproof.calibrate(file, method=oracle).status, "solved")

    def test_what_is_raised_or_wrong_comes_out(self):
        def raises(_):
            raise ZeroDivisionError("mine")
        pose = rigproof.Pose()
        for method, error, told in ((raises, ZeroDivisionError, "mine"), (lambda o: 3, TypeError, "returned int"),
                                    (lambda o: {"nobody": pose}, ValueError, "nobody"),
                                    (lambda o: {}, ValueError, "holds none"),
                                    (lambda o: {"left": np.eye(3)}, ValueError, r"\(3, 3\)"),
                                    (lambda o: {1: pose}, TypeError, "names"), (7, TypeError, "function")):
            with self.assertRaisesRegex(error, told):
                rigproof.calibrate(self.observations, method=method)

    def test_own_corners_are_checked_as_a_file_is(self):
        views = self.observations.board_views
        moved = [rigproof.BoardView(v.stop, v.camera, v.stamp_s, v.ids, v.pixels + 0.5, v.covariances_px2)
                 for v in views[::2]]
        self.observations.board_views = moved
        self.assertEqual(len(self.observations.board_views), len(moved))
        np.testing.assert_array_equal(self.observations.board_views[0].pixels, views[0].pixels + 0.5)
        v = views[0]
        for wrong in (rigproof.BoardView(99, 0, 0.0, v.ids, v.pixels), rigproof.BoardView(0, 7, 0.0, v.ids, v.pixels),
                      rigproof.BoardView(0, 0, 0.0, v.ids * 0, v.pixels),
                      rigproof.BoardView(0, 0, 0.0, v.ids, v.pixels, v.covariances_px2 * 0)):
            with self.assertRaises(rigproof.Error):
                self.observations.board_views = [wrong]
        self.assertEqual(len(self.observations.board_views), len(moved))
        for pixels in (v.pixels[:-1], v.pixels * np.nan, v.pixels.T):
            with self.assertRaises(ValueError):
                rigproof.BoardView(0, 0, 0.0, v.ids, pixels)
        self.observations.board_views = views

    def test_covariances_must_be_some(self):
        pose = rigproof.Pose()
        result = rigproof.Result("mine", {"left": pose}, covariances={"left": 4 * np.eye(6)})
        np.testing.assert_array_equal(result.camera_to_robot[0].sigma, np.full(6, 2.0))
        for covariances in ({"left": np.eye(5)}, {"left": np.full((6, 6), np.nan)}, {"left": np.triu(np.ones((6, 6)))},
                            {"right": np.eye(6)}):
            with self.assertRaises(ValueError):
                rigproof.Result("mine", {"left": pose}, covariances=covariances)
        with self.assertRaises(TypeError):
            rigproof.Result("mine", {"left": pose}, covariances={"left": "no"})

    def test_observations_travel_to_other_processes(self):
        self.assertEqual(pickle.loads(pickle.dumps(self.observations)).to_json(), self.observations.to_json())


class Threads(unittest.TestCase):
    def test_other_threads_go_on_and_ctrl_c_works(self):
        observations, _ = rigproof.draw(seed=2, stops=400)
        begin = time.process_time()
        rigproof.calibrate(observations, threads=1)
        ticks = []
        ended = threading.Event()

        def tick():
            while not ended.wait(1e-3):
                ticks.append(1)
        thread = threading.Thread(target=tick)
        thread.start()
        threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            while time.process_time() - begin < 60.0:
                rigproof.calibrate(observations)
        ended.set()
        thread.join()
        self.assertGreater(len(ticks), 1)


SWEEP = """mode: geometric
run: {poses: 8}
axes:
  lambda: {field: odometry.lambda, values: [0.5, 2]}
seeds: 2
methods: [ml, li]
"""


def always_there(observations):
    """Where nobody looks: one camera left out."""
    return {camera.name: rigproof.Pose.from_quaternion([0.3, i, 0.6], [0, 0, 0, 1])
            for i, camera in enumerate(observations.cameras[:-1])}


def breaks(_):
    raise RuntimeError("it broke")


def nonsense(_):
    return [1, 2, 3]


def never_ends(_):
    time.sleep(100.0)


class Sweeps(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.config = self.folder / "tiny.yaml"
        self.config.write_text(SWEEP)

    def test_rows_are_those_of_the_command_and_functions_answer_beside_them(self):
        told = []
        rows = rigproof.sweep(str(self.config), self.folder / "ours", methods=[always_there, breaks, nonsense],
                              progress=lambda done, all_: told.append((done, all_)))
        self.assertEqual(command("sweep", "start", self.config, "-o", self.folder / "theirs").returncode, 0)
        lines = (self.folder / "ours/rows.csv").read_text().splitlines()
        theirs = (self.folder / "theirs/rows.csv").read_text().splitlines()
        self.assertEqual([line for line in lines if not any(f.__name__ in line for f in (always_there, breaks, nonsense))],
                         theirs)
        rig = rows["subject"] == "rig"
        for function, status, reason in ((always_there, "partial", "no pose"), (breaks, "failed", "it broke"),
                                         (nonsense, "failed", "returned list")):
            chosen = rig & (rows["method"] == function.__name__)
            self.assertEqual(chosen.sum(), 4)
            self.assertEqual(set(rows["status"][chosen]), {status})
            self.assertTrue(all(reason in text for text in rows["reason"][chosen]), rows["reason"][chosen])
        self.assertEqual(set(rows["level_values"]["lambda"]), {0.5, 2.0})
        self.assertEqual(rows["error_cm_deg"].shape, (len(rig), 6))
        cameras = (rows["method"] == "ml") & (rows["subject"] == "camera")
        self.assertTrue(np.isfinite(rows["error_cm_deg"][cameras]).all())
        self.assertEqual({all_ for _, all_ in told}, {20})
        again = rigproof.sweep_rows(self.folder / "ours")
        np.testing.assert_array_equal(again["error_cm_deg"], rows["error_cm_deg"])

    def test_ctrl_c_ends_a_sweep_that_another_call_goes_on_with(self):
        threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            rigproof.sweep(str(self.config), self.folder / "ours", methods=[never_ends])
        self.assertLess(time.monotonic() - begin, 60.0)  # of the 400 s that it would sleep on one core
        rows = rigproof.sweep_rows(self.folder / "ours")
        self.assertNotIn("never_ends", rows["method"])

    def test_what_is_wrong_is_told(self):
        def ml(_):
            return {}
        for call in (lambda: rigproof.sweep("nowhere", self.folder / "x"),
                     lambda: rigproof.sweep(str(self.config), self.folder / "x", methods=[ml]),
                     lambda: rigproof.sweep(str(self.config), self.folder / "x", methods=["nobody"]),
                     lambda: rigproof.sweep(str(self.config), self.folder / "x", set=["run.posses=3"]),
                     lambda: rigproof.sweep_rows(self.folder),
                     lambda: rigproof.generate("demo", self.folder / "x", set=["posses=3"]),
                     lambda: rigproof.sense(self.folder, self.folder / "x", self.folder / "cache")):
            with self.assertRaises(rigproof.Error):
                call()
        with self.assertRaises(TypeError):
            rigproof.sweep(str(self.config), self.folder / "x", methods=[3])

    def test_a_run_has_the_same_bytes(self):
        changes = ["poses=2", "image_scale=0.25"]
        report = rigproof.generate("demo", self.folder / "ours", set=changes, cache=self.folder / "cache")
        self.assertEqual((report["images"], report["images_rendered"]), (6, 6))
        settings = [word for change in changes for word in ("--set", change)]
        out = command("generate", "demo", *settings, "-o", self.folder / "theirs")
        self.assertEqual(out.returncode, 0, out.stderr)
        self.assertEqual((self.folder / "ours/run.yaml").read_text(), (self.folder / "theirs/run.yaml").read_text())
        rigproof.sense(self.folder / "ours", self.folder / "other", self.folder / "cache", set=["sensing.seed=7"])
        ours, other = (rigproof.open(self.folder / name) for name in ("ours", "other"))
        name = ours.recording.frames["left"][0].color_file
        self.assertNotEqual((ours.recording.folder / name).read_bytes(), (other.recording.folder / name).read_bytes())
        self.assertEqual(other.truth.poses, ours.truth.poses)
        with self.assertRaisesRegex(rigproof.Error, "render key"):
            rigproof.sense(self.folder / "ours", self.folder / "third", self.folder / "cache", set=["poses=3"])

        def stop(_done, _all):
            raise StopIteration("enough")
        with self.assertRaisesRegex(StopIteration, "enough"):
            rigproof.generate("demo", self.folder / "stopped", set=changes, progress=stop)


class Stubs(unittest.TestCase):
    def test_they_name_what_there_is(self):
        tree = ast.parse(STUB.read_text())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        public = {name for name in dir(rigproof) if not name.startswith("_") and callable(getattr(rigproof, name))}
        self.assertEqual(public, set(classes) | functions)
        for name, node in classes.items():
            if name == "Error":
                continue
            told = {item.target.id if isinstance(item, ast.AnnAssign) else item.name for item in node.body
                    if isinstance(item, (ast.AnnAssign, ast.FunctionDef))}
            there = {member for member in dir(getattr(rigproof, name)) if not member.startswith("_")}
            self.assertEqual(there, {member for member in told if not member.startswith("_")}, name)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

#!/usr/bin/env python3
"""Judges camera poses against the truth of a run as `rigproof validate` does: one file, standard library only.

  score.py RUN                                   all of RUN/results
  score.py RUN theirs.yaml --budget limits.yaml  a result from elsewhere, with limits in cm and deg
  score.py truth.yaml theirs.yaml --json

A result is what `rigproof calibrate` writes, or a list of {parent, child, translation_m, quaternion_xyzw}; stddev or
covariance_m_rad may stand beside each; or MC-Calib's calibrated_cameras_data.yml. A budget has the keys of config/budgets/*.yaml; without one every error must be
within 4 of the stated standard deviations. Exit code 0: passed, 1: failed, 2: what was given cannot be read.
Errors: translation of the estimate minus that of the truth, Log(R_estimate R_truth^-1), metres and radians.
"""
import argparse
import json
import math
import os
import sys

AXES = ["tx", "ty", "tz", "rx", "ry", "rz"]
ROBOT = -1
# Columns: a camera's forward, left and up in its optical axes (x right, y down, z forward).
OPTICAL_FROM_BODY = [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]


class Bad(Exception):
    """What was given cannot be judged."""


# --------------------------------------------------------------------------------------------------------------- YAML

class Yaml:
    """Blocks, lists, flow style, quotes and comments: what such files are made of. No anchors, tags or block scalars."""

    def __init__(self, text, name):
        self.name, self.lines = name, []
        for number, line in enumerate(text.lstrip("\ufeff").splitlines(), 1):
            line = self.without_comment(line).rstrip()
            if line.strip() and line.strip() not in ("---", "...") and not line.startswith("%"):
                if "\t" in line[:len(line) - len(line.lstrip())]:
                    raise Bad("%s:%d: tabs do not indent" % (name, number))
                self.lines.append((number, len(line) - len(line.lstrip()), line.strip()))
        self.at = 0

    def tree(self):
        if not self.lines:
            return None
        value = self.block(self.lines[0][1])
        if self.at < len(self.lines):
            self.fail("is indented unlike what stands above")
        return value

    def fail(self, what):
        raise Bad("%s:%d: %s" % (self.name, self.lines[min(self.at, len(self.lines) - 1)][0], what))

    @staticmethod
    def without_comment(line):
        quote, i = "", 0
        while i < len(line):
            c = line[i]
            if quote == '"' and c == "\\":
                i += 1
            elif quote:
                quote = "" if c == quote else quote
            elif c in "\"'" and (i == 0 or line[i - 1] in " [{,:-"):
                quote = c
            elif c == "#" and (i == 0 or line[i - 1] in " \t"):
                return line[:i]
            i += 1
        return line

    def block(self, indent):
        text = self.lines[self.at][2]
        if text == "-" or text.startswith("- "):
            return self.sequence(indent)
        if text[0] not in "[{" and self.key_of(text):
            return self.mapping(indent)
        return self.inline(text, indent - 1)

    def sequence(self, indent):
        items = []
        while self.at < len(self.lines) and self.lines[self.at][1] == indent:
            number, _, text = self.lines[self.at]
            if text != "-" and not text.startswith("- "):
                break
            rest = text[1:].lstrip()
            if rest:  # what follows the dash is a block of its own
                self.lines[self.at] = (number, indent + len(text) - len(rest), rest)
                items.append(self.block(self.lines[self.at][1]))
            else:
                items.append(self.below(indent))
        return items

    def mapping(self, indent):
        entries = {}
        while self.at < len(self.lines) and self.lines[self.at][1] == indent:
            text = self.lines[self.at][2]
            found = self.key_of(text)
            if not found:
                self.fail("must be KEY: VALUE")
            key, rest = found
            if key in entries:
                self.fail("%s: the key is given twice" % key)
            if rest == "!!opencv-matrix":  # the one tag that is read: what follows is a block like any other
                rest = ""
            entries[key] = self.inline(rest, indent) if rest else self.below(indent, True)
        return entries

    def below(self, indent, of_key=False):
        """What is indented deeper in the following lines; a list of a key may stand as deep as the key."""
        self.at += 1
        if self.at == len(self.lines):
            return None
        _, depth, text = self.lines[self.at]
        is_list = of_key and depth == indent and (text == "-" or text.startswith("- "))
        return self.block(depth) if depth > indent or is_list else None

    def key_of(self, text):
        """(key, rest) of "key: rest"; None if it is no such thing."""
        if text[0] in "\"'":
            try:
                key, end = self.quoted(text, 0)
            except IndexError:
                return None
            if text[end:end + 1] == ":" and text[end + 1:end + 2] in ("", " "):
                return key, text[end + 1:].strip()
            return None
        for i, c in enumerate(text):
            if c == ":" and text[i + 1:i + 2] in ("", " "):
                return text[:i].strip(), text[i + 1:].strip()
        return None

    def inline(self, text, indent):
        """A scalar or flow style, which may go on in lines that are indented deeper."""
        if text[0] in "&*!|>":
            self.fail("anchors, tags and block scalars are not read")
        begin = self.at
        while True:
            try:
                value, end = self.flow(text, 0)
                break
            except IndexError:
                self.at += 1
                if self.at == len(self.lines) or self.lines[self.at][1] <= indent:
                    self.at = begin
                    self.fail("a bracket or quote is not closed")
                text += " " + self.lines[self.at][2]
        if text[end:].strip():
            if text[0] in "[{\"'":
                self.fail("nothing may follow \"%s\"" % text[:end][-20:])
            value = plain(text)
        self.at += 1
        return value

    def flow(self, text, i):
        """The value at i, and where it ends. IndexError: the text ends too early."""
        while text[i] == " ":
            i += 1
        if text[i] in "\"'":
            return self.quoted(text, i)
        if text[i] not in "[{":
            end = i
            while end < len(text) and text[end] not in ",]}" and text[end:end + 2] != ": ":
                end += 1
            return plain(text[i:end].strip()), end
        close = {"[": "]", "{": "}"}[text[i]]
        items, entries = [], {}
        i += 1
        while True:
            while text[i] in " ,":
                i += 1
            if text[i] == close:
                return (items if close == "]" else entries), i + 1
            value, i = self.flow(text, i)
            while text[i] == " ":
                i += 1
            if close == "}":
                if text[i] != ":":
                    self.fail("{..} must hold KEY: VALUE")
                entries[str(value)], i = self.flow(text, i + 1)
                while text[i] == " ":
                    i += 1
            else:
                items.append(value)
            if text[i] not in "," + close:
                self.fail("a comma is missing")

    def quoted(self, text, i):
        quote, out, i = text[i], "", i + 1
        escapes = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", "/": "/"}
        while True:
            c = text[i]
            if quote == '"' and c == "\\":
                digits = {"x": 2, "u": 4, "U": 8}.get(text[i + 1], 0)
                out += chr(int(text[i + 2:i + 2 + digits], 16)) if digits else escapes.get(text[i + 1], text[i + 1])
                i += 2 + digits
            elif c == quote and quote == "'" and text[i + 1:i + 2] == "'":
                out, i = out + "'", i + 2
            elif c == quote:
                return out, i + 1
            else:
                out, i = out + c, i + 1


def plain(text):
    if text in ("", "~", "null", "Null", "NULL"):
        return None
    return text


def read_yaml(path):
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise Bad("%s: %s" % (path, getattr(error, "strerror", None) or "is no text"))
    try:
        return Yaml(text, path).tree()
    except (RecursionError, ValueError):
        raise Bad("%s: is no YAML that can be read" % path)


# ------------------------------------------------------------------------------------------------- matrices, rotations

def times(a, b):
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def transposed(a):
    return [list(column) for column in zip(*a)]


def rotated(R, v):
    return [sum(x * y for x, y in zip(row, v)) for row in R]


def identity(n):
    return [[float(i == j) for j in range(n)] for i in range(n)]


def skew(v):
    return [[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]]


def carried(J, covariance):
    return times(times(J, covariance), transposed(J))


def blocks(a, b, c, d):
    """[[a, b], [c, d]] of 3 x 3 matrices."""
    return [x + y for x, y in zip(a, b)] + [x + y for x, y in zip(c, d)]


def negative(a):
    return [[-x for x in row] for row in a]


ZERO = [[0.0] * 3 for _ in range(3)]


def rotation_of_quaternion(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def rotation_vector(R):
    """Log(R), by the quaternion, so that small and large angles keep their digits."""
    trace = R[0][0] + R[1][1] + R[2][2]
    squares = [1 + 2 * R[0][0] - trace, 1 + 2 * R[1][1] - trace, 1 + 2 * R[2][2] - trace, 1 + trace]  # 4 x x .. 4 w w
    k = max(range(4), key=lambda i: squares[i])
    skewed = [R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]]  # 4 w x ..
    if k == 3:
        q = skewed + [squares[3]]
    else:
        q = [squares[k] if i == k else R[i][k] + R[k][i] for i in range(3)] + [skewed[k]]
    norm = math.sqrt(sum(x * x for x in q))
    q = [x / norm if q[3] >= 0 else -x / norm for x in q]
    size = math.sqrt(sum(x * x for x in q[:3]))
    factor = 2.0 if size < 1e-300 else 2.0 * math.atan2(size, q[3]) / size
    return [factor * x for x in q[:3]]


def roll_pitch_yaw(R):
    cosine = math.hypot(R[0][0], R[1][0])
    pitch = math.atan2(-R[2][0], cosine)
    if cosine < 1e-9:  # roll and yaw are one angle there
        return [0.0, pitch, math.atan2(-R[0][1], R[1][1])]
    yaw = math.atan2(R[1][0], R[0][0])
    c, s = math.cos(yaw), math.sin(yaw)
    return [math.atan2(s * R[0][2] - c * R[1][2], c * R[1][1] - s * R[0][1]), pitch, yaw]


def rotation_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]


def from_roll_pitch_yaw(angles):
    (cr, cp), (sr, sp) = map(math.cos, angles[:2]), map(math.sin, angles[:2])
    Ry, Rx = [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]], [[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]]
    return times(rotation_z(angles[2]), times(Ry, Rx))


def wrapped(angle):
    return math.remainder(angle, 2.0 * math.pi)


class Pose:
    """p_parent = R p_child + t."""

    def __init__(self, R, t):
        self.R, self.t = R, t

    def inverse(self):
        R = transposed(self.R)
        return Pose(R, [-x for x in rotated(R, self.t)])

    def __mul__(self, other):
        return Pose(times(self.R, other.R), [a + b for a, b in zip(rotated(self.R, other.t), self.t)])


def inverse_error_jacobian(T):
    R = negative(transposed(T.R))
    return blocks(R, times(R, skew(T.t)), ZERO, R)


def relative_error_jacobian(first, second):
    R = transposed(first.R)
    lever = times(R, skew([b - a for a, b in zip(first.t, second.t)]))
    minus = negative(R)
    return [a + b + c + d for a, b, c, d in zip(minus, lever, R, ZERO)] + \
           [a + b + c + d for a, b, c, d in zip(ZERO, minus, ZERO, R)]


# ------------------------------------------------------------------------------------------------------------- reading

def number(value, where):
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise Bad("%s: %s: must be a number" % (where, value))
    if not math.isfinite(result):
        raise Bad("%s: %s: must be finite" % (where, value))
    return result


def numbers(value, count, where):
    if not isinstance(value, list) or len(value) != count:
        raise Bad("%s: must be a list of %d numbers" % (where, count))
    return [number(x, where) for x in value]


def read_pose(tree, where):
    for key in ("translation_m", "quaternion_xyzw"):
        if not isinstance(tree, dict) or key not in tree:
            raise Bad("%s: %s is missing" % (where, key))
    q = numbers(tree["quaternion_xyzw"], 4, where + ": quaternion_xyzw")
    norm = math.sqrt(sum(x * x for x in q))
    if not abs(norm - 1.0) <= 1e-3:
        raise Bad("%s: quaternion_xyzw: has the norm %g; it must be 1 within 0.001, order x y z w" % (where, norm))
    return Pose(rotation_of_quaternion([x / norm for x in q]),
                numbers(tree["translation_m"], 3, where + ": translation_m"))


def read_triangle(lines, rows, size, where):
    """A covariance from its upper triangle; what is not given is unknown: infinite, without correlation."""
    if not isinstance(lines, list) or len(lines) != len(rows):
        raise Bad("%s: must be an upper triangle of %d rows" % (where, len(rows)))
    matrix = [[math.inf if i == j else 0.0 for j in range(size)] for i in range(size)]
    for i, line in enumerate(lines):
        for j, value in enumerate(numbers(line, len(rows) - i, where)):
            matrix[rows[i]][rows[i + j]] = matrix[rows[i + j]][rows[i]] = value
    for i in rows:
        for j in rows:
            variances = matrix[i][i] * matrix[j][j]
            if matrix[i][i] < 0 or variances < 0 or abs(matrix[i][j]) > math.sqrt(variances) * (1 + 1e-6):
                raise Bad(where + ": is no covariance: variances must not be negative, correlations at most 1")
    return matrix


class Estimate:
    def __init__(self, tree, where, child, parent_is_camera):
        if not isinstance(tree, dict):
            raise Bad(where + ": must be a block {parent, child, translation_m, quaternion_xyzw}")
        self.parent, self.child = tree.get("parent"), tree.get("child", child)
        if not self.parent or not self.child or self.parent == self.child:
            raise Bad(where + ": parent and child must be two frames")
        where += " (pose of %s in %s)" % (self.child, self.parent)
        missing = tree.get("unobservable") or []
        if not isinstance(missing, list) or any(name not in AXES for name in missing):
            raise Bad(where + ": unobservable: must be a list of tx, ty, tz, rx, ry, rz")
        self.observable = [axis not in missing for axis in AXES]
        self.T = read_pose(tree, where) if not missing else self.partial_pose(tree, where, parent_is_camera)
        self.covariance = self.read_covariance(tree, where)

    def partial_pose(self, tree, where, parent_is_camera):
        keys = ["tx_m", "ty_m", "tz_m", "roll_rad", "pitch_rad", "yaw_rad"]
        v = [number(tree.get(key), where + ": " + key) if seen else 0.0 for key, seen in zip(keys, self.observable)]
        R = times(from_roll_pitch_yaw(v[3:]), transposed(OPTICAL_FROM_BODY))
        return Pose(times(OPTICAL_FROM_BODY, R) if parent_is_camera else R, v[:3])

    def read_covariance(self, tree, where):
        rows = [i for i in range(6) if self.observable[i]]
        if tree.get("covariance_m_rad") is not None:
            return read_triangle(tree["covariance_m_rad"], rows, 6, where + ": covariance_m_rad")
        keys = ["tx_cm", "ty_cm", "tz_cm", "rx_deg", "ry_deg", "rz_deg"]
        stddev = tree.get("stddev") or {}
        if len(rows) < 6 or any(stddev.get(key) is None for key in keys):
            return None
        sigma = [number(stddev[key], where + ": stddev") for key in keys]
        if min(sigma) < 0:
            raise Bad(where + ": stddev: must not be negative")
        si = [x / (100.0 if i < 3 else 180.0 / math.pi) for i, x in enumerate(sigma)]
        return [[si[i] ** 2 if i == j else 0.0 for j in range(6)] for i in range(6)]

    def heading_free(self):
        """Without a known yaw: in the axes in which the camera looks along the robot's x."""
        if self.observable[5]:
            return
        turn = rotation_z(-roll_pitch_yaw(times(self.T.R, OPTICAL_FROM_BODY))[2])
        self.T = Pose(times(turn, self.T.R), self.T.t)
        if self.covariance:
            seen = self.observable
            known = [[x if seen[i] and seen[j] else 0.0 for j, x in enumerate(row)]
                     for i, row in enumerate(self.covariance)]
            self.covariance = carried(blocks(identity(3), ZERO, ZERO, turn), known)


def read_estimates(tree, where, parent_is_camera):
    if tree is None:
        return []
    if isinstance(tree, list):
        return [Estimate(item, "%s[%d]" % (where, i), "", parent_is_camera) for i, item in enumerate(tree)]
    if isinstance(tree, dict):
        return [Estimate(item, "%s.%s" % (where, name), name, parent_is_camera)
                for name, item in tree.items() if not name.startswith("x-")]
    raise Bad(where + ": must be a list or a map of transforms")


class Result:
    def __init__(self, path):
        tree = read_yaml(path)
        self.method, self.status, self.joint, self.suspicions = "foreign", "solved", None, []
        if isinstance(tree, dict) and "format" in tree:
            self.read_own(tree, path)
        elif isinstance(tree, dict) and "nb_camera" in tree and "camera_0" in tree:
            self.read_mcalib(tree, path)
        else:
            self.read_foreign(tree, path)
        for group in (self.to_robot, self.to_camera):
            names = [(e.parent, e.child) for e in group]
            for parent, child in names:
                if names.count((parent, child)) > 1:
                    raise Bad("%s: the pose of %s in %s is given twice" % (path, child, parent))

    def read_own(self, tree, path):
        if tree["format"] != "rigproof-result":
            raise Bad("%s: format: must be rigproof-result" % path)
        self.method, self.status = tree.get("method", ""), tree.get("status")
        if self.status not in ("solved", "partial", "refused"):
            raise Bad("%s: status: must be solved, partial or refused" % path)
        notes = tree.get("notes") or []
        if not isinstance(notes, list):
            raise Bad("%s: notes: must be a list" % path)
        suspicious = [note for note in notes if isinstance(note, dict) and note.get("severity") == "suspect"]
        self.suspicions = [str(note.get("code", "")) for note in suspicious]
        self.to_robot = read_estimates(tree.get("camera_to_robot"), path + ": camera_to_robot", False)
        self.to_camera = read_estimates(tree.get("camera_to_camera"), path + ": camera_to_camera", True)
        if tree.get("joint_covariance_m_rad") is not None:
            rows = [6 * n + i for n, e in enumerate(self.to_robot) for i in range(6) if e.observable[i]]
            self.joint = read_triangle(tree["joint_covariance_m_rad"], rows, 6 * len(self.to_robot),
                                       path + ": joint_covariance_m_rad")

    def read_mcalib(self, tree, path):
        """MC-Calib's calibrated_cameras_data.yml: poses in its first camera; names from camera_params.yml beside it."""
        beside = os.path.join(os.path.dirname(path), "camera_params.yml")
        lenses = read_yaml(beside) if os.path.exists(beside) else {}
        self.method, self.to_robot, self.to_camera, first = "mcalib", [], [], None
        for k in range(int(number(tree["nb_camera"], path + ": nb_camera"))):
            key = "camera_%d" % k
            where, camera = "%s: %s" % (path, key), tree.get(key)
            if not isinstance(camera, dict) or not isinstance(camera.get("camera_pose_matrix"), dict):
                raise Bad(where + ": camera_pose_matrix is missing")
            m = numbers(camera["camera_pose_matrix"].get("data"), 16, where + ": camera_pose_matrix")
            T, name = Pose([m[0:3], m[4:7], m[8:11]], [m[3], m[7], m[11]]), key
            if isinstance(lenses, dict) and isinstance(lenses.get(key), dict):
                name = lenses[key].get("name") or key
            if first is None:
                first = (name, T.inverse(), camera.get("camera_group"))
            elif camera.get("camera_group") != first[2]:
                self.status = "partial"
            else:
                estimate = Estimate.__new__(Estimate)
                estimate.parent, estimate.child, estimate.T = first[0], name, first[1] * T
                estimate.covariance, estimate.observable = None, [True] * 6
                self.to_camera.append(estimate)

    def read_foreign(self, tree, path):
        if isinstance(tree, dict) and "transforms" in tree:
            self.method = tree.get("method") or self.method
            tree = tree["transforms"]
        estimates = read_estimates(tree, path, False)
        if not estimates:
            raise Bad("%s: holds no transform" % path)
        children = {e.child for e in estimates}
        self.to_robot = [e for e in estimates if e.parent not in children]
        self.to_camera = [e for e in estimates if e.parent in children]


def read_truth(path):
    tree = read_yaml(path)
    cameras = tree.get("cameras") if isinstance(tree, dict) else None
    if not isinstance(cameras, dict) or tree.get("format") != "rigproof-truth":
        raise Bad("%s: is no truth of a run" % path)
    return [(name, read_pose(camera.get("T_robot_camera"), "%s: %s" % (path, name))) for name, camera in cameras.items()]


class Budget:
    def __init__(self, path=None):
        tree = read_yaml(path) if path else {"max_z": 4}
        blocks_of = ("camera_to_robot", "camera_to_camera")
        if not isinstance(tree, dict) or any(key not in blocks_of + ("max_z",) for key in tree):
            raise Bad("%s: allowed are camera_to_robot, camera_to_camera and max_z" % path)
        self.max_z = self.limit(tree, "max_z", path)
        self.nothing_suspected = path is not None   # who writes limits asks for a gate
        self.limits = {block: self.read_limits(tree.get(block), "%s: %s" % (path, block)) for block in blocks_of}
        if self.max_z is None and not any(self.limits.values()):
            raise Bad("%s: a budget needs at least one limit" % path)

    @staticmethod
    def limit(tree, key, where):
        value = number(tree.get(key) if tree.get(key) is not None else 0.0, "%s: %s" % (where, key))
        if not 0.0 <= value <= 1e6:
            raise Bad("%s: %s: must be 0 to 1e6" % (where, key))
        return value if value > 0.0 else None

    def read_limits(self, tree, where):
        """Metres and radians, None = not limited; None if nothing is."""
        if tree is None:
            return None
        own = [axis + ("_cm" if i < 3 else "_deg") for i, axis in enumerate(AXES)]
        if not isinstance(tree, dict) or any(key not in own + ["distance_cm", "angle_deg"] for key in tree):
            raise Bad("%s: allowed are %s, distance_cm, angle_deg" % (where, ", ".join(own)))
        limits = []
        for i, key in enumerate(own):
            value = self.limit(tree, key, where) or self.limit(tree, "distance_cm" if i < 3 else "angle_deg", where)
            limits.append(value and (0.01 * value if i < 3 else math.radians(value)))
        return limits if any(limits) else None


# ----------------------------------------------------------------------------------------------------------- comparing

class Statement:
    """In the truth's direction: the parent is the robot or the earlier camera."""

    def __init__(self, estimate, parent, child, joint_index=-1):
        self.parent, self.child, self.T = parent, child, estimate.T
        self.covariance, self.observable = estimate.covariance, estimate.observable
        self.reversed, self.joint_index = child < parent, joint_index
        if self.reversed:
            if self.covariance:
                self.covariance = carried(inverse_error_jacobian(self.T), self.covariance)
            self.parent, self.child, self.T = child, parent, self.T.inverse()


class Comparison:
    def __init__(self, result, truth):
        self.result, self.truth, self.cameras = result, truth, [name for name, _ in truth]
        self.statements, robots, problems = {}, set(), []
        listed = [(e, i) for i, e in enumerate(result.to_robot)] + [(e, -1) for e in result.to_camera]
        for estimate, joint_index in listed:
            self.add(estimate, joint_index, robots, problems)
        if len(robots) > 1:
            problems.append("%s: more than one name that is no camera of the truth" % ", ".join(sorted(robots)))
        if problems:
            raise Bad("\n".join(problems))
        self.missing = [name for i, name in enumerate(self.cameras) if (ROBOT, i) not in self.statements]
        self.to_robot = [self.error(self.statements[ROBOT, i], "robot", name, T)
                         for i, (name, T) in enumerate(truth) if (ROBOT, i) in self.statements]
        self.to_camera = []
        for j in range(len(truth)):
            for k in range(j + 1, len(truth)):
                statement = self.statements.get((j, k)) or self.composed(j, k)
                if statement:
                    T = truth[j][1].inverse() * truth[k][1]
                    self.to_camera.append(self.error(statement, truth[j][0], truth[k][0], T))

    def add(self, estimate, joint_index, robots, problems):
        index = {name: i for i, name in enumerate(self.cameras)}
        parent, child = index.get(estimate.parent, ROBOT), index.get(estimate.child, ROBOT)
        what = "%s -> %s: " % (estimate.parent, estimate.child)
        if parent == child:
            return problems.append(what + "names no camera of the truth (cameras: %s)" % ", ".join(self.cameras))
        robots.update({estimate.parent} if parent == ROBOT else {estimate.child} if child == ROBOT else set())
        if parent == ROBOT:
            estimate.heading_free()
        if child < parent and not all(estimate.observable):
            return problems.append(what + "degrees of freedom that are not observable are told in the robot's axes only")
        statement = Statement(estimate, parent, child, joint_index)
        if (statement.parent, statement.child) in self.statements:
            return problems.append(what + "this pair is stated twice")
        self.statements[statement.parent, statement.child] = statement
        return None

    def joint_of(self, two):
        if not self.result.joint or any(s.joint_index < 0 for s in two):
            return None
        select = []
        for s in two:
            J = inverse_error_jacobian(s.T.inverse()) if s.reversed else identity(6)
            for row in J:
                select.append([0.0] * len(self.result.joint))
                select[-1][6 * s.joint_index:6 * s.joint_index + 6] = row
        return carried(select, self.result.joint)

    def composed(self, j, k):
        two = [self.statements.get((ROBOT, i)) for i in (j, k)]
        if any(s is None or not all(s.observable) for s in two):
            return None
        joint = self.joint_of(two)
        estimate = Estimate.__new__(Estimate)
        estimate.T, estimate.observable = two[0].T.inverse() * two[1].T, [True] * 6
        estimate.covariance = joint and carried(relative_error_jacobian(two[0].T, two[1].T), joint)
        return Statement(estimate, j, k)

    @staticmethod
    def error(statement, parent, child, T_true):
        between, seen = statement.parent != ROBOT, statement.observable
        body = OPTICAL_FROM_BODY
        angles_true = roll_pitch_yaw(times(T_true.R, body))
        t = [a if s else b for a, b, s in zip(statement.T.t, T_true.t, seen)]
        R = statement.T.R
        if not all(seen[3:]):
            angles = [a if s else b for a, b, s in zip(roll_pitch_yaw(times(R, body)), angles_true, seen[3:])]
            R = times(from_roll_pitch_yaw(angles), transposed(body))
        error = [a - b for a, b in zip(t, T_true.t)] + rotation_vector(times(R, transposed(T_true.R)))
        if not between and not seen[5]:
            error[3:] = rotated(rotation_z(-angles_true[2]), error[3:])
        sigma = statement.covariance and [math.sqrt(max(0.0, statement.covariance[i][i])) for i in range(6)]
        z = [error[i] / sigma[i] if sigma and seen[i] and sigma[i] > 0.0 else None for i in range(6)]
        shown = sigma and [x if math.isfinite(x) else None for x in sigma]
        front = transposed(body) if between else identity(3)
        read = [roll_pitch_yaw(times(times(front, M), body)) for M in (R, T_true.R)]
        return {"parent": parent, "child": child, "error_m_rad": error, "sigma_m_rad": shown, "z": z,
                "observable": list(seen), "roll_pitch_yaw_error_rad": [wrapped(a - b) for a, b in zip(*read)]}


# ------------------------------------------------------------------------------------------------------------- judging

def check(name, passed, value=None, limit=None, unit="", code=""):
    return {"name": name, "passed": passed, "value": value, "limit": limit, "unit": unit, "code": code}


def checks_of(error, name, limits, max_z):
    for i, axis in enumerate(AXES):
        if limits and limits[i]:
            size, scale, unit = abs(error["error_m_rad"][i]), *((100.0, "cm") if i < 3 else (180 / math.pi, "deg"))
            seen = error["observable"][i]
            yield check("%s: %s" % (name, axis), seen and size <= limits[i], scale * size, scale * limits[i], unit,
                        "" if seen else "gate.unanswered")
        if max_z is not None and error["z"][i] is not None:
            z = abs(error["z"][i])
            yield check("%s: %s" % (name, axis), z <= max_z, z, max_z, "sigma")


def judge(comparison, budget):
    checks = []
    pairs_only = comparison.result.status == "solved" and not comparison.to_robot and comparison.to_camera and \
        not budget.limits["camera_to_robot"]
    if not pairs_only:
        checks += [check(name + " in robot: pose", False, code="gate.no_pose") for name in comparison.missing]
    for e in comparison.to_robot:
        checks += checks_of(e, "%s in robot" % e["child"], budget.limits["camera_to_robot"], budget.max_z)
    for e in comparison.to_camera:
        checks += checks_of(e, "%s-%s" % (e["parent"], e["child"]), budget.limits["camera_to_camera"], budget.max_z)
    if budget.nothing_suspected:
        checks += [check("nothing suspected", False, code=code) for code in comparison.result.suspicions]
    return checks


def record_of(path, truth, budget):
    result = Result(path)
    try:
        comparison = Comparison(result, truth)
    except Bad as error:
        raise Bad("%s: %s" % (path, error))
    checks = judge(comparison, budget)
    return {"subject": os.path.basename(path), "method": result.method, "status": result.status,
            "passed": bool(checks) and all(c["passed"] for c in checks), "camera_to_robot": comparison.to_robot,
            "camera_to_camera": comparison.to_camera, "missing_cameras": comparison.missing, "checks": checks}


def told(record):
    lines = ["%s (%s)  error: tx ty tz [cm], rx ry rz [deg]" % (record["subject"], record["status"])]
    for e in record["camera_to_robot"] + record["camera_to_camera"]:
        shown = ["%9.4f" % (x * (100.0 if i < 3 else 180 / math.pi)) if e["observable"][i] else "        -"
                 for i, x in enumerate(e["error_m_rad"])]
        lines.append("  %-24s%s" % ("%s in %s" % (e["child"], e["parent"]), "".join(shown)))
    failed = [c for c in record["checks"] if not c["passed"]]
    for c in failed:
        lines.append("  failed: " + c["name"] + (": %.4g %s, allowed %.4g %s" % (c["value"], c["unit"], c["limit"],
                     c["unit"]) if c["unit"] and not c["code"] else " (%s)" % c["code"]))
    passed = len(record["checks"]) - len(failed)
    lines.append("%s  %d/%d checks" % ("PASS" if record["passed"] else "FAIL", passed, len(record["checks"])))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", help="a run, or its truth/truth.yaml")
    parser.add_argument("results", nargs="*", help="default: all of RUN/results")
    parser.add_argument("--budget", help="a file of limits; default: 4 of the stated standard deviations")
    parser.add_argument("--json", action="store_true", help="with the keys of rigproof validate --json")
    options = parser.parse_intermixed_args()
    try:
        is_run = os.path.isdir(options.run)
        truth = read_truth(os.path.join(options.run, "truth", "truth.yaml") if is_run else options.run)
        folder = os.path.join(options.run, "results")
        results = options.results
        if not results and is_run and os.path.isdir(folder):
            results = [os.path.join(folder, name) for name in sorted(os.listdir(folder)) if name.endswith(".yaml")]
        if not results:
            raise Bad("there is no result to judge")
        budget = Budget(options.budget)
        records = [record_of(path, truth, budget) for path in results]
    except Bad as error:
        print(error, file=sys.stderr)
        return 2
    passed = all(record["passed"] for record in records)
    print(json.dumps({"passed": passed, "results": records}) if options.json else
          "\n\n".join(told(record) for record in records))
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())

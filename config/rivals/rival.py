"""What the descriptions in this folder share: whether a program is there, board views by OpenCV, and the result."""
import importlib
import json
import shutil
import subprocess
import sys
from pathlib import Path


def needs(what, package):
    """A module by its name, or the path of a program; says what to install where it is not there."""
    found = shutil.which(what)
    try:
        return found or importlib.import_module(what)
    except ImportError:
        sys.exit(f"{what} is not installed: apt-get install {package}")


def run(*command, **environment):
    """Runs a program and returns its output, which stays in the log as well."""
    print("$", *command, flush=True)
    done = subprocess.run([str(word) for word in command], check=False, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, **environment)
    print(done.stdout, flush=True)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: exit code {done.returncode}")
    return done.stdout


class Recording:
    """A folder as `rigproof convert --to opencv` writes it, its board searched by OpenCV as OpenCV's manual does."""

    def __init__(self, folder):
        self.cv2 = cv2 = needs("cv2", "python3-opencv")
        np = needs("numpy", "python3-numpy")
        self.folder = Path(folder)
        listed = self.folder / "recording.yml"
        if not listed.is_file():
            sys.exit(f"{listed}: is not there; give a folder as `rigproof convert --to opencv` writes it")
        file = cv2.FileStorage(str(listed), cv2.FILE_STORAGE_READ)
        self.T_world_robot = file.getNode("T_world_robot").mat().reshape(-1, 4, 4)
        corners = file.getNode("board_corners")
        self.grid = (int(corners.at(0).real()), int(corners.at(1).real()))
        square_m = file.getNode("board_square_m").real()
        self.points = np.array([[x * square_m, y * square_m, 0.0] for y in range(self.grid[1]) for x in range(self.grid[0])])
        self.names, self.normal_views = [], []
        for k in range(int(file.getNode("cameras").real())):
            def node(key):
                return file.getNode(f"camera{k}_{key}")
            fisheye = node("lens").string() == "kannala_brandt"
            images = [node("images").at(i).string() for i in range(node("images").size())]
            self.names.append(node("name").string())
            self.normal_views.append(self._views(images, node("K").mat(), node("D").mat(), fisheye))

    def _views(self, images, K, D, fisheye):
        """Corners of a stop as a camera without distortion and of focal length one has them (n x 2), or None."""
        cv2, views = self.cv2, []
        undistorted = cv2.fisheye.undistortPoints if fisheye else cv2.undistortPoints
        for name in images:
            image = cv2.imread(str(self.folder / name), cv2.IMREAD_GRAYSCALE) if name else None
            found, corners = (False, None) if image is None else cv2.findChessboardCorners(image, self.grid)
            if found:
                corners = cv2.cornerSubPix(image, corners, (11, 11), (-1, -1), (3, 30, 0.1))
                corners = undistorted(corners.astype(float).reshape(-1, 1, 2), K, D).reshape(-1, 2)
            views.append(corners if found else None)
        return views

    def board_poses(self, k):
        """(stop, R, t) of T_camera_board by solvePnP, where the board was found."""
        np, cv2 = needs("numpy", "python3-numpy"), self.cv2
        for stop, corners in enumerate(self.normal_views[k]):
            if corners is not None:
                _, r, t = cv2.solvePnP(self.points, corners, np.eye(3), None)
                yield stop, cv2.Rodrigues(r)[0], t.ravel()


def transform(parent, child, R, t):
    """An entry of a result: the pose of `child` in `parent`, R (3 x 3), t [m]."""
    w = max(0.0, 1.0 + R[0][0] + R[1][1] + R[2][2]) ** 0.5 / 2.0
    if w > 0.1:
        q = [(R[2][1] - R[1][2]) / (4 * w), (R[0][2] - R[2][0]) / (4 * w), (R[1][0] - R[0][1]) / (4 * w), w]
    else:  # near half a turn: from the largest diagonal entry
        i = max(range(3), key=lambda n: R[n][n])
        j, k = (i + 1) % 3, (i + 2) % 3
        s = 2.0 * max(1e-12, 1.0 + R[i][i] - R[j][j] - R[k][k]) ** 0.5
        q = [0.0, 0.0, 0.0, (R[k][j] - R[j][k]) / s]
        q[i], q[j], q[k] = s / 4, (R[j][i] + R[i][j]) / s, (R[k][i] + R[i][k]) / s
    norm = sum(x * x for x in q) ** 0.5
    return {"parent": parent, "child": child, "translation_m": [float(x) for x in t],
            "quaternion_xyzw": [float(x) / norm for x in q]}


def write_result(file, method, camera_to_robot=(), camera_to_camera=()):
    result = {"format": "rigproof-result", "version": 1, "method": method, "camera_to_robot": list(camera_to_robot),
              "camera_to_camera": list(camera_to_camera)}
    if not result["camera_to_robot"] and not result["camera_to_camera"]:
        sys.exit(f"{method} found no pose")
    result["status"] = "solved"
    Path(file).write_text(json.dumps(result), encoding="utf-8")

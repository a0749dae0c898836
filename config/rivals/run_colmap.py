"""Camera to camera by COLMAP's structure from motion and rig bundle adjustment, without a board; the odometry gives the
scale. Usage: run_colmap.py FOLDER RESULT"""
import csv
import json
import math
import os
import sys
from itertools import combinations
from pathlib import Path

from rival import needs, run, transform, write_result

colmap, np = needs("colmap", "colmap"), needs("numpy", "python3-numpy")
# Features of an image: on a processor without CUDA the manual's 8192 take sixteen times as long to match as these.
FEATURES = 2048


def solve(cameras):
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    for camera in cameras:
        prefix = camera["image_prefix"]
        files = "".join(f"{prefix}{path.name}\n" for path in sorted(Path("images", prefix).iterdir()))
        Path("list.txt").write_text(files, encoding="utf-8")
        run(colmap, "feature_extractor", "--database_path", "database.db", "--image_path", "images", "--image_list_path", "list.txt",
            "--ImageReader.single_camera", 1, "--ImageReader.camera_model", camera["camera_model_name"],
            "--ImageReader.camera_params", ",".join(str(x) for x in camera["camera_params"]),
            "--SiftExtraction.use_gpu", 0, "--SiftExtraction.max_num_features", FEATURES)
    run(colmap, "exhaustive_matcher", "--database_path", "database.db", "--SiftMatching.use_gpu", 0)
    run(colmap, "mapper", "--database_path", "database.db", "--image_path", "images", "--output_path", ".",
        "--Mapper.ba_refine_focal_length", 0, "--Mapper.ba_refine_extra_params", 0)
    run(colmap, "rig_bundle_adjuster", "--input_path", "0", "--output_path", "0", "--rig_config_path", "rig_config.json",
        "--BundleAdjustment.refine_focal_length", 0, "--BundleAdjustment.refine_extra_params", 0)
    run(colmap, "model_converter", "--input_path", "0", "--output_path", "0", "--output_type", "TXT")


def rotation(w, x, y, z):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def poses():
    """T_model_camera as (R, t) by image name; lines of points stand between those of images."""
    found = {}
    for line in Path("0/images.txt").read_text(encoding="utf-8").splitlines():
        words = line.split()
        if len(words) == 10 and not line.startswith("#"):
            R, t = rotation(*map(float, words[1:5])), np.array([float(x) for x in words[5:8]])
            found[words[9]] = (R.T, -R.T @ t)
    return found


def scale_of(views, stops):
    """The model's scale [m a unit]. In planar motion A X = X B says for the
    robot's axes x, y: s R_X t_B = R_A t_X + t_A - t_X, linear in s cos yaw, s sin yaw, tx, ty once the axis of turning, which is
    the robot's z, is known in the camera."""
    names = sorted(set(views) & set(stops))
    up, rows, values = np.zeros(3), [], []
    motions = []
    for a, b in combinations(names, 2):
        (Ra, ta), (Rb, tb) = views[a], views[b]
        turn = stops[b][2] - stops[a][2]
        R = Ra.T @ Rb
        axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])  # 2 sin(angle) times the axis
        up += math.copysign(1.0, math.sin(turn)) * axis
        dx, dy = stops[b][0] - stops[a][0], stops[b][1] - stops[a][1]
        c, s = math.cos(stops[a][2]), math.sin(stops[a][2])
        motions.append((Ra.T @ (tb - ta), turn, np.array([c * dx + s * dy, -s * dx + c * dy])))
    up /= np.linalg.norm(up)
    forward = np.cross(np.cross(up, [0.0, 0.0, 1.0]), up)
    forward /= np.linalg.norm(forward)
    level = np.array([forward, np.cross(up, forward), up])  # camera axes to those of a level frame that looks ahead
    for step, turn, moved in motions:
        x, y, _ = level @ step
        c, s = math.cos(turn), math.sin(turn)
        rows += [[x, -y, 1 - c, s], [y, x, -s, 1 - c]]
        values += list(moved)
    sc, ss, _, _ = np.linalg.lstsq(np.array(rows), np.array(values), rcond=None)[0]
    return math.hypot(sc, ss)


def main():
    result = Path(sys.argv[2]).resolve()
    os.chdir(sys.argv[1])
    cameras = json.loads(Path("rig_config.json").read_text(encoding="utf-8"))[0]["cameras"]
    solve(cameras)
    with open("odometry.csv", encoding="utf-8") as file:
        stops = {row["stop"]: (float(row["x_m"]), float(row["y_m"]), float(row["yaw_rad"])) for row in csv.DictReader(file)}
    views = {}
    for name, pose in poses().items():
        camera, image = name.split("/")[1:]
        views.setdefault(camera, {})[Path(image).stem] = pose
    names = [camera["image_prefix"].split("/")[1] for camera in cameras]
    found = [name for name in names if len(views.get(name, ())) >= 3]
    scale = sum(scale_of(views[name], stops) for name in found) / len(found)
    pairs = []
    for parent, child in combinations(found, 2):
        stop = next(iter(sorted(set(views[parent]) & set(views[child]))), None)
        if stop:  # after the rig adjustment every stop says the same
            (Ra, ta), (Rb, tb) = views[parent][stop], views[child][stop]
            pairs.append(transform(parent, child, Ra.T @ Rb, scale * (Ra.T @ (tb - ta))))
    write_result(result, "colmap", camera_to_camera=pairs)


if __name__ == "__main__":
    main()

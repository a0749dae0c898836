"""Camera to camera by mrcal's library, on corners of ours: its detector reads square grids alone. Starts from the declared
lenses, which mrcal-calibrate-cameras 2.2 cannot, and solves for them as well.
Usage: run_mrcal.py FOLDER RESULT (a folder as `rigproof convert --to mrcal` writes it)"""
import os
import sys
from itertools import combinations
from pathlib import Path

from rival import needs, transform, write_result

mrcal = needs("mrcal", "python3-mrcal")
np = needs("numpy", "python3-numpy")
# Corners are good to hundredths of a pixel; a solve above this is astray.
MOST_RMS_PX = 1.0


def read_arguments(file):
    """arguments.txt of mrcal-calibrate-cameras: its options by name, and the cameras."""
    words = Path(file).read_text(encoding="utf-8").split("\n")
    options = {name: value for name, value in zip(words, words[1:]) if name.startswith("--")}
    return options, [word[:-len("/*.png")] for word in words if word.endswith("/*.png")]


def read_corners(options, names):
    """-> corners (n x height x width x [x, y, weight]), (stop, camera) of each"""
    width, height, file = int(options["--object-width-n"]), int(options["--object-height-n"]), options["--corners-cache"]
    try:
        corners, indices, _ = mrcal.compute_chessboard_corners(
            width, height, corners_cache_vnl=file, globs_per_camera=[f"{name}/*.png" for name in names])
    except Exception as error:  # whatever mrcal throws of a file that is not as it expects
        sys.exit(f"{file}: mrcal cannot read it as corners of a board of {width} x {height}: {error}")
    return corners, indices


def declared_lenses(names):
    """-> model, intrinsics of each (n x parameters), sizes [px]"""
    models = [mrcal.cameramodel(f"{name}.cameramodel") for name in names]
    intrinsics = np.array([model.intrinsics()[1] for model in models])
    bent = np.any(intrinsics[:, 4:])
    sizes = np.array([model.imagersize() for model in models], dtype=np.int32)
    return ("LENSMODEL_OPENCV5", intrinsics, sizes) if bent else ("LENSMODEL_PINHOLE", intrinsics[:, :4].copy(), sizes)


def arrange(boards, cameras):
    """Pose of the first camera in each that shares stops with it, by way of others if need be: {index: rt_camera_first}.
    boards: {(stop, camera): rt_camera_board}"""
    found, waiting = {0: np.zeros(6)}, [0]
    while waiting:
        known = waiting.pop(0)
        for k in set(range(cameras)) - found.keys():
            rts = [mrcal.compose_rt(rt, mrcal.invert_rt(boards[stop, known])) for (stop, at), rt in boards.items()
                   if at == k and (stop, known) in boards]
            if rts:
                middle = min(rts, key=lambda rt: sum(np.linalg.norm(rt - other) for other in rts))
                found[k] = mrcal.compose_rt(middle, found[known])
                waiting.append(k)
    return found


def solve(lens, views, boards, arranged, spacing):
    """First poses by the lenses as declared, then all together: rt_camera_first of each camera, and the error's RMS [px].
    lens: of declared_lenses; views: {(stop, camera): corners}"""
    order = sorted(arranged)
    seen = sorted(key for key in views if key[1] in arranged)
    stops = sorted({stop for stop, _ in seen})
    in_first = {stop: mrcal.compose_rt(mrcal.invert_rt(arranged[k]), boards[stop, k]) for stop, k in reversed(seen)}
    inputs = {
        "lensmodel": lens[0],
        "intrinsics": lens[1][order],
        "imagersizes": lens[2][order],
        "extrinsics_rt_fromref": np.array([arranged[k] for k in order[1:]]).reshape(-1, 6),
        "frames_rt_toref": np.array([in_first[stop] for stop in stops]),
        "observations_board": np.array([views[key] for key in seen]),
        "indices_frame_camintrinsics_camextrinsics":
            np.array([(stops.index(stop), order.index(k), order.index(k) - 1) for stop, k in seen], dtype=np.int32),
        "points": None, "observations_point": None, "indices_point_camintrinsics_camextrinsics": None,
        "calibration_object_spacing": spacing,
        "calobject_warp": np.zeros(2),
        "do_apply_outlier_rejection": False,  # which takes boards whose first pose is astray for outliers
    }
    poses_alone = {f"do_optimize_{what}": False for what in ("intrinsics_core", "intrinsics_distortions", "calobject_warp")}
    mrcal.optimize(**inputs, **poses_alone)
    rms_px = mrcal.optimize(**inputs)["rms_reproj_error__pixels"]
    return dict(zip(order, [np.zeros(6), *inputs["extrinsics_rt_fromref"]])), rms_px


def main():
    result = Path(sys.argv[2]).resolve()
    if not (Path(sys.argv[1]) / "arguments.txt").is_file():
        sys.exit(f"{sys.argv[1]}/arguments.txt: is not there; give a folder as `rigproof convert --to mrcal` writes it")
    os.chdir(sys.argv[1])
    options, names = read_arguments("arguments.txt")
    spacing = float(options["--object-spacing"])
    corners, indices = read_corners(options, names)
    lens = declared_lenses(names)
    Rt_camera_board = mrcal.estimate_monocular_calobject_poses_Rt_tocam(
        indices, corners, spacing, [(lens[0], intrinsics) for intrinsics in lens[1]])
    keys = [tuple(int(i) for i in pair) for pair in indices]
    boards = {key: mrcal.rt_from_Rt(Rt) for key, Rt in zip(keys, Rt_camera_board)}
    arranged = arrange(boards, len(names))
    if len(arranged) < 2:
        sys.exit(f"no camera saw the board together with {names[0]}: mrcal has no way from one to another")
    solved, rms_px = solve(lens, dict(zip(keys, corners)), boards, arranged, spacing)
    print(f"RMS reprojection error {rms_px:.4f} px")
    if rms_px > MOST_RMS_PX:
        sys.exit(f"mrcal did not converge: RMS reprojection error {rms_px:.1f} px")
    poses = []
    for parent, child in combinations(sorted(solved), 2):
        T = mrcal.Rt_from_rt(mrcal.compose_rt(solved[parent], mrcal.invert_rt(solved[child])))
        poses.append(transform(names[parent], names[child], T[:3], T[3]))
    write_result(result, "mrcal", camera_to_camera=poses)


if __name__ == "__main__":
    main()

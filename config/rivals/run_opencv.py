"""Camera to camera by OpenCV's stereoCalibrate, camera to robot by its calibrateHandEye; lenses as declared.
Usage: run_opencv.py FOLDER RESULT"""
import sys
from itertools import combinations

from rival import Recording, needs, transform, write_result

cv2, np = needs("cv2", "python3-opencv"), needs("numpy", "python3-numpy")


def camera_to_camera(recording, parent, child):
    """Pose of a camera in another one, or None where they share no stop."""
    views = zip(recording.normal_views[parent], recording.normal_views[child])
    pairs = [(a, b) for a, b in views if a is not None and b is not None]
    if not pairs:
        return None
    points = [recording.points.astype(np.float32)] * len(pairs)
    first, second = ([view.astype(np.float32).reshape(-1, 1, 2) for view in views] for views in zip(*pairs))
    # Corners without distortion, of focal length one: the lens is a parameter of findings, not of the problem.
    found = cv2.stereoCalibrate(points, first, second, np.eye(3), None, np.eye(3), None, (1, 1), flags=cv2.CALIB_FIX_INTRINSIC,
                                criteria=(3, 200, 1e-12))
    R, t = found[5], found[6].ravel()  # T_child_parent
    return transform(recording.names[parent], recording.names[child], R.T, -R.T @ t)


def camera_to_robot(recording, k):
    poses = list(recording.board_poses(k))
    if len(poses) < 3:
        return None
    robots = [recording.T_world_robot[stop] for stop, _, _ in poses]
    R, t = cv2.calibrateHandEye([T[:3, :3] for T in robots], [T[:3, 3] for T in robots], [R for _, R, _ in poses],
                                [t for _, _, t in poses])
    return transform("robot", recording.names[k], R, t.ravel()) if np.all(np.isfinite(R)) and np.all(np.isfinite(t)) else None


if __name__ == "__main__":
    seen = Recording(sys.argv[1])
    cameras = range(len(seen.names))
    write_result(sys.argv[2], "opencv", filter(None, (camera_to_robot(seen, k) for k in cameras)),
                 filter(None, (camera_to_camera(seen, *pair) for pair in combinations(cameras, 2))))

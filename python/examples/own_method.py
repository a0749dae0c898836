#!/usr/bin/env python3
"""A calibration method as a Python function, beside `ml` on the same data: height, roll and pitch from the mean ground
plane, x, y and yaw from a drawing of the robot that is a little wrong."""
import numpy as np

import rigproof


def ground_and_drawing(observations):
    """The camera's height and tilt as the ground planes tell; the rest as the drawing does."""
    poses = {}
    for index, camera in enumerate(observations.cameras):
        planes = [plane.inverse_depth_plane_per_m for plane in observations.ground_planes if plane.camera == index]
        if not planes:
            return rigproof.Result.refused("ground_and_drawing", f"{camera.name}: sees no ground")
        a = np.mean(planes, axis=0)  # -n / h
        up, height_m = -a / np.linalg.norm(a), 1.0 / np.linalg.norm(a)
        x, y, heading = DRAWING[camera.name]
        forward = np.array([0.0, 0.0, 1.0]) - up[2] * up  # the optical axis, on the ground
        forward /= np.linalg.norm(forward)
        level = np.stack([forward, np.cross(up, forward), up])  # of the robot's axes before it turns
        c, s = np.cos(heading), np.sin(heading)
        T_robot_camera = np.eye(4)
        T_robot_camera[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ level
        T_robot_camera[:3, 3] = x, y, height_m
        poses[camera.name] = T_robot_camera
    return poses


observations, truth = rigproof.draw(seed=3, stops=30)
DRAWING = {}
for name, pose in truth.poses.items():
    z_axis = pose.rotation[:, 2]
    DRAWING[name] = (*np.round(pose.translation_m[:2], 2), np.round(np.arctan2(z_axis[1], z_axis[0]), 2))

for method in (ground_and_drawing, "ml"):
    result = rigproof.calibrate(observations, method=method)
    errors = np.array([error.error for error in rigproof.validate(result, truth).camera_to_robot])
    print(f"{result.method:20} worst [mm] {1e3 * np.abs(errors[:, :3]).max(axis=0).round(5)}",
          f"[mrad] {1e3 * np.abs(errors[:, 3:]).max(axis=0).round(5)}")
    assert np.abs(errors[:, 2]).max() < 0.01  # the ground knows the height

#!/usr/bin/env python3
"""Corners of your own detector in place of ours, and what projection's derivatives say of a pixel."""
import numpy as np

import rigproof

observations, truth = rigproof.draw(seed=5, stops=25, corner_sigma_px=0.1)

# Where the truth says that each corner is: a detector without any error.
views = []
for view in observations.board_views:
    T_camera_board = (truth.T_world_robot[view.stop] @ truth.cameras[view.camera].T_robot_camera).inverse() @ truth.T_world_board
    corners_m = T_camera_board @ truth.board.corners_m[view.ids]
    pixels, J_pixel_point = truth.cameras[view.camera].camera.project(corners_m, jacobians=True)
    sigma_px = np.full((len(view.ids), 1, 1), 0.01)
    views.append(rigproof.BoardView(view.stop, view.camera, view.stamp_s, view.ids, pixels, sigma_px**2 * np.eye(2),
                                    board=view.board))
print("a millimetre to the right moves the first corner by", 1e-3 * J_pixel_point[0, :, 0], "px")

before = rigproof.calibrate(observations)
observations.board_views = views  # checked as a file's would be
after = rigproof.calibrate(observations)
for name, result in (("detected", before), ("exact", after)):
    pair = result.camera_to_camera[0]
    print(f"{name:9} {pair.parent}-{pair.child} +- {1e3 * pair.sigma[:3].max():.4f} mm")
assert after.camera_to_camera[0].sigma[:3].max() < before.camera_to_camera[0].sigma[:3].max()

# The board's pose in every view.
poses = rigproof.view_poses(observations)
distance_m = [np.linalg.norm(pose.T_camera_board.translation_m) for pose in poses]
print(f"{len(poses)} views from {min(distance_m):.2f} to {max(distance_m):.2f} m")

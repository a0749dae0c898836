#!/usr/bin/env python3
"""Calibrates, and compares with the truth and with the best that the data allow.
Usage: first_steps.py [RUN]   a run that `rigproof run` made; without one, a drive is drawn without images"""
import sys

import numpy as np

import rigproof

if len(sys.argv) > 1:
    run = rigproof.open(sys.argv[1])
    observations, truth = run.observations, run.truth
else:
    observations, truth = rigproof.draw(seed=0, stops=40)

result = rigproof.calibrate(observations)
print(result.status, "|", *result.notes)
for camera in result.camera_to_robot:
    print(camera.child, camera.T_parent_child.translation_m, "+-", camera.sigma[:3], "m")

print(rigproof.validate(result, truth))
for bound in rigproof.bound(observations, truth)[:len(observations.cameras)]:
    print("the data allow", bound["child"], "+-", np.round(1e3 * bound["sigma"][:3], 3), "mm")

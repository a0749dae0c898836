"""Height, roll and pitch of every camera from the ground planes alone: the smallest useful method from outside.
Usage: ground_only.py OBSERVATIONS.json RESULT.yaml"""
import json
import math
import sys

observations = json.load(open(sys.argv[1]))
poses = []
for index, name in enumerate(observations["cameras"]):
    planes = [p["inverse_depth_plane_per_m"] for p in observations["ground_planes"] if p["camera"] == index]
    if not planes:
        continue
    # The plane is a . p = 1 in camera axes (x right, y down, z forward): up is -a / |a|, the height 1 / |a|.
    a = [sum(plane[i] for plane in planes) / len(planes) for i in range(3)]
    size = math.sqrt(sum(x * x for x in a))
    right, down, forward = (-x / size for x in a)
    x, y, z = forward, -right, -down  # up in body axes: x forward, y left, z up
    poses.append({"parent": observations["robot_frame"], "child": name, "tz_m": 1.0 / size,
                  "roll_rad": math.atan2(y, z), "pitch_rad": math.asin(-x), "unobservable": ["tx", "ty", "rz"]})
json.dump({"format": "rigproof-result", "version": 1, "method": "ground_only", "status": "solved",
           "camera_to_robot": poses}, open(sys.argv[2], "w"))

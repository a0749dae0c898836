"""Camera to camera by mrcal-calibrate-cameras, on corners of ours: its detector reads square grids alone.
Usage: run_mrcal.py FOLDER RESULT (a folder as `rigproof convert --to mrcal` writes it)"""
import os
import re
import sys
from itertools import combinations
from pathlib import Path

from rival import needs, run, transform, write_result

program = needs("mrcal-calibrate-cameras", "mrcal")
mrcal = needs("mrcal", "python3-mrcal")
# Corners are good to hundredths of a pixel; a solve above this is astray.
MOST_RMS_PX = 1.0


def main():
    result = Path(sys.argv[2]).resolve()
    os.chdir(sys.argv[1])
    arguments = Path("arguments.txt").read_text(encoding="utf-8").splitlines()
    names = [argument[:-len("/*.png")] for argument in arguments if argument.endswith("/*.png")]
    models = [mrcal.cameramodel(f"{name}.cameramodel") for name in names]
    focals = ",".join(str(model.intrinsics()[1][0]) for model in models)
    lens = "OPENCV5" if any(any(model.intrinsics()[1][4:]) for model in models) else "PINHOLE"
    os.makedirs("solved")
    said = run(program, "--lensmodel", f"LENSMODEL_{lens}", "--focal", focals, "--outdir", "solved", *arguments)
    rms_px = float(re.findall(r"RMS reprojection error: (\S+)", said)[-1])
    if rms_px > MOST_RMS_PX:
        sys.exit(f"mrcal did not converge: RMS reprojection error {rms_px} px")
    solved = [mrcal.cameramodel(f"solved/camera-{k}.cameramodel") for k in range(len(names))]
    poses = []
    for (parent, at), (child, model) in combinations(zip(names, solved), 2):
        T_parent_child = mrcal.compose_Rt(at.extrinsics_Rt_fromref(), model.extrinsics_Rt_toref())
        poses.append(transform(parent, child, T_parent_child[:3], T_parent_child[3]))
    write_result(result, "mrcal", camera_to_camera=poses)


if __name__ == "__main__":
    main()

"""Camera to robot by ViSP's hand-eye calibration, of board poses by OpenCV. Usage: run_visp.py FOLDER RESULT"""
import re
import subprocess
import sys
from pathlib import Path

from rival import Recording, needs, run, transform, write_result

visp_config = needs("visp-config", "libvisp-dev")
compiler = needs("g++", "g++")


def matrix_text(R, t):
    return " ".join(repr(float(x)) for x in [*R[0], t[0], *R[1], t[1], *R[2], t[2]])


def main():
    seen = Recording(sys.argv[1])
    program = Path("hand_eye").resolve()
    flags = [subprocess.run([visp_config, flag], check=True, capture_output=True, text=True).stdout.split()
             for flag in ("--cflags", "--libs")]
    run(compiler, "-O2", "-w", Path(__file__).with_name("visp.cpp"), *flags[0], "-o", program, *flags[1])
    poses = []
    for k, name in enumerate(seen.names):
        lines = [matrix_text(seen.T_world_robot[stop][:3, :3], seen.T_world_robot[stop][:3, 3]) + "\n" + matrix_text(R, t)
                 for stop, R, t in seen.board_poses(k)]
        if len(lines) < 3:
            print(f"{name}: the whole board in {len(lines)} images, of which a hand-eye calibration needs three")
            continue
        done = subprocess.run([program], input="\n".join(lines), check=True, capture_output=True, text=True)
        print(name, done.stdout.strip())
        if answer := re.search(r"^T_robot_camera (.*)$", done.stdout, re.MULTILINE):
            numbers = [float(word) for word in answer.group(1).split()]
            rows = [numbers[i:i + 4] for i in (0, 4, 8)]
            poses.append(transform("robot", name, [row[:3] for row in rows], [row[3] for row in rows]))
    write_result(sys.argv[2], "visp", poses)


if __name__ == "__main__":
    main()

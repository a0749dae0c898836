// A small folder in the layout of the MEMROC authors' program.
#pragma once

#include "temp_folder.h"

namespace rigproof {

/// Two cameras, frames 0 to 2; camera2 has no frame 1.
struct MemrocFolder : TempFolder {
  MemrocFolder() {
    write("CalibrationInfo.yaml",
          "%YAML:1.0\n---\nnumber_of_cameras: 2\ncamera_folder_prefix: camera\npattern_type: checkerboard\n"
          "number_of_rows: 3\nnumber_of_columns: 4\nsize: 0.1\nresize_factor: 1\n");
    for (const char* camera : {"camera1", "camera2"}) {
      const std::string folder = std::string(camera) + "/";
      write(folder + "intrinsic_pars_file.yaml", intrinsics("0.1", "0"));
      for (const int frame : {0, 1, 2}) {
        if (frame == 1 && folder == "camera2/") continue;
        const std::string number = "000" + std::to_string(frame);
        write(folder + "image/" + number + ".png", "png");
        write(folder + "clouds/" + number + ".txt", "0 0 1\n");
        write(folder + "pose/" + number + ".csv", pose(frame * 0.5, frame));
      }
    }
  }

  static std::string intrinsics(const std::string& k0, const std::string& k5) {
    return "fx: 800.0\nfy: 801.0\ncx: 639.5\ncy: 359.5\nhas_dist_coeff: 1\ndist_k0: " + k0 +
           "\ndist_k1: -0.2\ndist_px: 0.001\ndist_py: 0.002\ndist_k2: 0.05\ndist_k3: 0.0\ndist_k4: 0.0\ndist_k5: " +
           k5 + "\nimg_width: 1280\nimg_height: 720\n";
  }
  /// A quarter turn to the left for every frame, then x.
  static std::string pose(double x_m, int quarter_turns) {
    static const char* const kRotations[] = {"1,0,0", "0,-1,0", "-1,0,0"};
    static const char* const kSecond[] = {"0,1,0", "1,0,0", "0,-1,0"};
    return std::string(kRotations[quarter_turns]) + "," + std::to_string(x_m) + "\n" + kSecond[quarter_turns] +
           ",0.25\n0,0,1,0\n0,0,0,1\n";
  }
};

}  // namespace rigproof

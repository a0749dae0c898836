// A world of one's own, small enough to compose and drive in within milliseconds.
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "temp_folder.h"

namespace rigproof {

/// It has a bit of everything that can be varied.
class TinyWorld {
 public:
  TinyWorld() {
    write_mjcf("0.5");
    write_picture(90);
    folder_.write("tiny.yaml", text("0.8"));
    folder_.write("other.yaml", text("0.7"));
  }

  std::string scene() const { return (folder_ / "tiny.yaml").string(); }
  std::string other_scene() const { return (folder_ / "other.yaml").string(); }
  const TempFolder& folder() const { return folder_; }

  void write_mjcf(const std::string& floor_specular) const {
    folder_.write("tiny.xml", R"(<mujoco><asset>
<material name="tiny_floor" texture="tiny_floor" texrepeat="1 1" texuniform="true" specular=")" +
                                  floor_specular + R"("/>
<material name="tiny_wall" texture="tiny_wall" texrepeat="1 1" texuniform="true"/></asset><worldbody>
<light directional="true" pos="0 0 3" dir="0.5 0.3 -0.8" castshadow="true" diffuse="0.5 0.5 0.5"/>
<geom name="floor" type="plane" size="20 20 1" material="tiny_floor"/>
<geom name="wall" type="box" pos="6 0 1" size="3 1 0.05" xyaxes="0 -1 0 0 0 1" material="tiny_wall"/>
<geom name="pillar" type="box" pos="0 1.0 0.5" size="0.3 0.3 0.5"/></worldbody></mujoco>)");
  }
  void write_picture(int level) const {
    cv::imwrite((folder_ / "wall.png").string(), cv::Mat(16, 16, CV_8UC3, cv::Scalar(level, 100, 110)));
  }

 private:
  static std::string text(const std::string& sky) {
    return R"(mjcf: tiny.xml
outdoor: true
drivable_area: {x_min_m: -4, x_max_m: 4, y_min_m: -4, y_max_m: 4}
board: {x_m: 4.5, y_m: 0, z_m: 0.8, facing_deg: 180, lean_deg: 0, roll_deg: 0}
straight_path: {x_m: 1, y_m: -2, heading_deg: 180, length_m: 2}
sky_zenith: [0.3, 0.5, )" +
           sky + R"(]
cloud_cover: 0.3
shadows: true
textures:
  - {name: tiny_floor, type: tiles, size_px: 32, color: [0.5, 0.5, 0.5]}
  - {name: tiny_wall, type: file, file: wall.png, size_px: 16}
objects:
  - {kind: box, place_m: [5.4, 2.5], heading_deg: 10}
scatter:
  - {kind: box, count: 2, x_m: 5.2, y_m: {uniform: [-3, -2]}}
)";
  }

  TempFolder folder_;
};

}  // namespace rigproof

// Writes the layout of the EuRoC MAV data set (ASL), which Kalibr and many others read: mav0/camN and mav0/odom0.
#include <fmt/core.h>

#include <cmath>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Nanoseconds, of equal width, so that names sort by time.
std::string stamp_text(double stamp_s) { return fmt::format("{:019}", std::llround(1e9 * stamp_s)); }

void refuse_what_cannot_be_said(const Recording& recording) {
  Problems problems;
  const std::string file = (recording.folder / "rig.yaml").string();
  for (const RigCamera& camera : recording.rig.cameras)
    if (camera.camera.lens == Lens::kBrownConrady && camera.camera.distortion[4] != 0.0)
      problems.add({file, 0, "cameras." + camera.name + ".distortion", number_text(camera.camera.distortion[4]),
                    "EuRoC's radial-tangential lens has k1 k2 p1 p2 only; k3 must be 0"});
  for (const std::vector<CameraFrame>& frames : recording.frames)
    for (const CameraFrame& frame : frames)
      if (!(frame.stamp_s >= 0.0 && frame.stamp_s < 9e9))
        problems.add({frame.color_file, frame.line, "stamp_s", number_text(frame.stamp_s),
                      "must be 0 to 9e9 s, to be told in nanoseconds"});
  problems.throw_if_any();
}

YamlTree sensor_of(const RigCamera& camera) {
  const Camera& lens = camera.camera;
  const bool fisheye = lens.lens == Lens::kKannalaBrandt;
  YamlTree tree = YamlTree::map();
  tree.set("sensor_type", YamlTree::text("camera"));
  tree.set("comment", YamlTree::text(camera.name));
  tree.set("resolution", YamlTree::numbers({double(lens.width_px), double(lens.height_px)}));
  tree.set("camera_model", YamlTree::text("pinhole"));
  tree.set("intrinsics", YamlTree::numbers({lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px}));
  tree.set("distortion_model", YamlTree::text(fisheye ? "equidistant" : "radial-tangential"));
  tree.set("distortion_coefficients",
           YamlTree::numbers({lens.distortion[0], lens.distortion[1], lens.distortion[2], lens.distortion[3]}));
  return tree;
}

// As Kalibr's --target wants it.
YamlTree target_of(const Board& board) {
  YamlTree tree = YamlTree::map();
  if (board.has_tags()) {
    const double tag = board.marker_side_m();
    tree.set("target_type", YamlTree::text("aprilgrid"));
    tree.set("tagCols", YamlTree::number(board.squares_x));
    tree.set("tagRows", YamlTree::number(board.squares_y));
    tree.set("tagSize", YamlTree::number(tag));
    tree.set("tagSpacing", YamlTree::number(board.square_m / tag - 1.0));
    return tree;
  }
  tree.set("target_type", YamlTree::text("checkerboard"));
  tree.set("targetCols", YamlTree::number(board.inner_corners_x()));
  tree.set("targetRows", YamlTree::number(board.inner_corners_y()));
  tree.set("colSpacingMeters", YamlTree::number(board.square_m));
  tree.set("rowSpacingMeters", YamlTree::number(board.square_m));
  return tree;
}

std::string odometry_text(const std::vector<OdometrySample>& odometry) {
  std::string text = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
  for (const OdometrySample& sample : odometry)
    text += stamp_text(sample.stamp_s) + "," + number_text(sample.x_m) + "," + number_text(sample.y_m) + ",0," +
            number_text(std::cos(0.5 * sample.yaw_rad)) + ",0,0," + number_text(std::sin(0.5 * sample.yaw_rad)) + "\n";
  return text;
}

std::size_t image_total(const Recording& recording) {
  std::size_t count = 0;
  for (const auto& frames : recording.frames) count += frames.size();
  return count;
}

ConvertReport write_euroc(const WriteJob& job) {
  const Recording& recording = job.recording;
  refuse_what_cannot_be_said(recording);
  ConvertReport report;
  const std::size_t total = image_total(recording);
  for (std::size_t k = 0; k < recording.rig.cameras.size(); ++k) {
    const fs::path folder = job.folder / "mav0" / ("cam" + std::to_string(k));
    create_folder(folder / "data");
    std::string list = "#timestamp [ns],filename\n";
    for (const CameraFrame& frame : recording.frames[k]) {
      const fs::path image = path_inside(recording.folder, frame.color_file);
      const std::string name = stamp_text(frame.stamp_s) + image.extension().string();
      copy_file_into(image, folder / "data" / name);
      list += stamp_text(frame.stamp_s) + "," + name + "\n";
      job.step(++report.images, total);
    }
    write_file_atomically_unsynced(folder / "data.csv", list);
    write_file_atomically_unsynced(folder / "sensor.yaml", emit_yaml(sensor_of(recording.rig.cameras[k])));
    report.notes.push_back(recording.rig.cameras[k].name + " is cam" + std::to_string(k) + " there.");
  }
  write_file_atomically_unsynced(job.folder / "mav0" / "odom0" / "data.csv",
                                 odometry_text(odometry_of_origin(recording)));
  if (recording.rig.board.type != "charuco")
    write_file_atomically_unsynced(job.folder / "target.yaml", emit_yaml(target_of(recording.rig.board)));
  else
    report.notes.push_back("The board (" + recording.rig.board.type + ") is not told.");
  report.notes.emplace_back(
      "Depth has no place in that layout. T_BS of the cameras is not told: it is what is to be found.");
  return report;
}

}  // namespace

Format euroc_format() {
  Format format;
  format.name = "euroc";
  format.what = "the EuRoC layout";
  format.write = write_euroc;
  return format;
}

}  // namespace rigproof

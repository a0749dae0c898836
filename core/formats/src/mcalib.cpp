// Writes what MC-Calib reads: images, its settings, the lenses, and our corners in place of its detector's, which knows
// ChArUco boards alone.
#include "opencv_text.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "stop_images.h"

namespace rigproof {
namespace {

std::string lens_index(const Camera& camera) { return camera.lens == Lens::kKannalaBrandt ? "1" : "0"; }

std::string settings_text(const Observations& observations) {
  const Board& board = observations.board;
  std::vector<std::string> lenses;
  for (const RigCamera& camera : observations.cameras) lenses.push_back(lens_index(camera.camera));
  std::string text = "%YAML:1.0\n---\n";
  const auto add = [&text](const std::string& key, const std::string& value) { text += key + ": " + value + "\n"; };
  add("number_x_square", std::to_string(board.squares_x));
  add("number_y_square", std::to_string(board.squares_y));
  add("resolution_x", "500");
  add("resolution_y", "500");
  add("length_square", "0.04");
  add("length_marker", "0.03");
  add("number_board", "1");
  add("boards_index", "[]");
  add("square_size", number_text(board.square_m));
  for (const char* key : {"number_x_square_per_board", "number_y_square_per_board", "square_size_per_board"})
    add(key, "[]");
  add("distortion_model", "0");
  add("distortion_per_camera", "[" + joined(lenses) + "]");
  add("number_camera", std::to_string(observations.cameras.size()));
  add("refine_corner", "1");
  add("min_perc_pts", "0.5");
  add("cam_params_path", "\"camera_params.yml\"");
  add("fix_intrinsic", "1");
  add("root_path", "\"./\"");
  add("cam_prefix", "\"Cam_\"");
  add("keypoints_path", "\"detected_keypoints_data.yml\"");
  add("ransac_threshold", "3");
  add("number_iterations", "1000");
  add("he_approach", "0");
  add("save_path", "\"./\"");
  add("save_detection", "0");
  add("save_reprojection", "0");
  add("camera_params_file_name", "\"\"");
  return text;
}

std::string camera_key(std::size_t k) { return "camera_" + std::to_string(k); }

std::string size_text(const Camera& camera) {
  return "   img_width: " + std::to_string(camera.width_px) + "\n   img_height: " + std::to_string(camera.height_px) +
         "\n";
}

// MC-Calib does not ask for the name; what reads its answer does.
std::string lens_text(const RigCamera& rig_camera, std::size_t k) {
  const Camera& camera = rig_camera.camera;
  return camera_key(k) + ":\n   name: \"" + rig_camera.name + "\"\n" +
         opencv_lens(camera, "camera_matrix", "distortion_vector", 3) + "   distortion_type: " + lens_index(camera) +
         "\n" + size_text(camera);
}

std::string list_text(const std::string& key, const std::vector<std::string>& items) {
  if (items.empty()) return "   " + key + ": []\n";
  std::string text = "   " + key + ":\n";
  for (const std::string& item : items) text += "      - " + item + "\n";
  return text;
}

std::string keypoints_text(const Observations& observations, std::size_t k, const std::vector<std::string>& images) {
  std::vector<std::string> stops, names, boards, pixels, ids;
  for (const BoardView& view : observations.board_views) {
    if (static_cast<std::size_t>(view.camera) != k) continue;
    std::vector<std::string> view_pixels, view_ids;
    for (const CornerObservation& corner : view.corners) {
      for (const double value : corner.pixel) view_pixels.push_back(fixed_text(value, 6));
      view_ids.push_back(std::to_string(corner.id));
    }
    names.push_back("\"" + images[stops.size()] + "\"");
    stops.push_back(std::to_string(view.stop));
    boards.emplace_back("0");
    pixels.push_back("[" + joined(view_pixels) + "]");
    ids.push_back("[" + joined(view_ids) + "]");
  }
  return camera_key(k) + ":\n" + size_text(observations.cameras[k].camera) + "   frame_idxs: [" + joined(stops) +
         "]\n" + list_text("frame_paths", names) + "   board_idxs: [" + joined(boards) + "]\n" +
         list_text("pts_2d", pixels) + list_text("charuco_idxs", ids);
}

ConvertReport write_mcalib(const WriteJob& job) {
  const Observations observations = job.observations();
  const std::string count = std::to_string(observations.cameras.size());
  ConvertReport report;
  std::string lenses = "%YAML:1.0\n---\nnb_camera: " + count + "\n", keypoints = lenses;
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    const std::string folder = "Cam_" + stop_number(k + 1).substr(1);
    lenses += lens_text(observations.cameras[k], k);
    keypoints += keypoints_text(observations, k, copy_board_images(job, observations, k, folder, &report.images));
    report.notes.push_back(observations.cameras[k].name + " is " + folder + " there.");
  }
  write_file_atomically_unsynced(job.folder / "calib_param.yml", settings_text(observations));
  write_file_atomically_unsynced(job.folder / "camera_params.yml", lenses);
  write_file_atomically_unsynced(job.folder / "detected_keypoints_data.yml", keypoints);
  report.notes.emplace_back("Odometry and depth have no place in that layout.");
  return report;
}

}  // namespace

Format mcalib_format() {
  Format format;
  format.name = "mcalib";
  format.equal_squares = true;
  format.what = "MC-Calib's folder";
  format.write = write_mcalib;
  return format;
}

}  // namespace rigproof

// Writes what mrcal-calibrate-cameras reads: our corners as a vnlog in place of its detector's, the images that they
// are of, and a camera model each.
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "stop_images.h"

namespace rigproof {
namespace {

void refuse_fisheyes(const Recording& recording) {
  Problems problems;
  for (const RigCamera& camera : recording.rig.cameras)
    if (camera.camera.lens == Lens::kKannalaBrandt)
      problems.add({(recording.folder / "rig.yaml").string(), 0, "cameras." + camera.name + ".lens",
                    lens_name(camera.camera.lens), "mrcal has no such lens; must be pinhole or brown_conrady"});
  problems.throw_if_any();
}

// LENSMODEL_OPENCV5 is brown_conrady; zeros make it a pinhole, so that all cameras of a solve have one model. Where it
// is mounted is what is to be found: that of a seed must not tell.
std::string camera_model(const Camera& camera) {
  std::string numbers;
  for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px})
    numbers += number_text(value) + ", ";
  for (const double value : camera.distortion) numbers += number_text(value) + ", ";
  return "{\n    'lensmodel': 'LENSMODEL_OPENCV5',\n    'intrinsics': [ " + numbers +
         "],\n    'extrinsics': [ 0, 0, 0, 0, 0, 0 ],\n    'imagersize': [ " + std::to_string(camera.width_px) + ", " +
         std::to_string(camera.height_px) + " ]\n}\n";
}

// Every corner of the board, a line each; level "-" where it was not seen.
std::string corner_lines(const BoardView& view, const Board& board, const std::string& image) {
  std::vector<std::string> lines(static_cast<std::size_t>(board.inner_corners_x() * board.inner_corners_y()),
                                 image + " 0 0 -\n");
  for (const CornerObservation& corner : view.corners)
    lines.at(static_cast<std::size_t>(corner.id)) =
        image + " " + number_text(corner.pixel.x()) + " " + number_text(corner.pixel.y()) + " 0\n";
  return joined(lines, "");
}

// A line each, as `xargs -a arguments.txt mrcal-calibrate-cameras` reads them.
std::string arguments_text(const Observations& observations) {
  const Board& board = observations.board;
  std::string text = "--corners-cache\ncorners.vnl\n--object-spacing\n" + number_text(board.square_m) +
                     "\n--object-width-n\n" + std::to_string(board.inner_corners_x()) + "\n--object-height-n\n" +
                     std::to_string(board.inner_corners_y()) + "\n";
  for (const RigCamera& camera : observations.cameras) text += camera.name + "/*.png\n";
  return text;
}

ConvertReport write_mrcal(const WriteJob& job) {
  refuse_fisheyes(job.recording);
  const Observations observations = job.observations();
  ConvertReport report;
  std::string corners = "# filename x y level\n";
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    const std::string& name = observations.cameras[k].name;
    const std::vector<std::string> images = copy_board_images(job, observations, k, name, &report.images);
    std::size_t next = 0;
    for (const BoardView& view : observations.board_views)
      if (static_cast<std::size_t>(view.camera) == k) corners += corner_lines(view, observations.board, images[next++]);
    write_file_atomically_unsynced(job.folder / (name + ".cameramodel"), camera_model(observations.cameras[k].camera));
  }
  write_file_atomically_unsynced(job.folder / "corners.vnl", corners);
  write_file_atomically_unsynced(job.folder / "arguments.txt", arguments_text(observations));
  report.notes.emplace_back("Odometry, depth and the corners' covariances have no place in that layout.");
  return report;
}

}  // namespace

Format mrcal_format() {
  Format format;
  format.name = "mrcal";
  format.equal_squares = true;
  format.what = "mrcal's corners and camera models";
  format.write = write_mrcal;
  return format;
}

}  // namespace rigproof

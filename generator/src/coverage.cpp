#include "rigproof/generator/coverage.h"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "places.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// Of the places that possible_coverage() tries: fine enough that the board moves by less than a cell from one to the
// next.
constexpr int kDistances = 16, kBearings = 5, kHeadings = 90;

// What one camera has been shown.
class Shown {
 public:
  void add(const Camera& camera, const std::vector<Eigen::Vector2d>& corners) {
    ++coverage_.stops;
    for (const Eigen::Vector2d& pixel : corners) {
      cells_.set(image_cell(camera, pixel));
      lowest_ = std::min(lowest_, pixel.y());
      highest_ = std::max(highest_, pixel.y());
    }
  }

  CameraCoverage told(const WorldCamera& camera) const {
    CameraCoverage coverage = coverage_;
    coverage.camera = camera.name;
    coverage.rows = camera.camera.height_px;
    coverage.cells = cells_.count();
    if (coverage.cells == 0) return coverage;
    coverage.top_row_px = lowest_;
    coverage.bottom_row_px = highest_;
    return coverage;
  }

 private:
  CameraCoverage coverage_;
  std::bitset<kImageCells> cells_;
  double lowest_ = 1e9, highest_ = -1e9;
};

std::vector<CameraCoverage> told(const std::vector<Shown>& shown, const ViewpointSubject& subject) {
  std::vector<CameraCoverage> coverages;
  for (std::size_t i = 0; i < shown.size(); ++i) coverages.push_back(shown[i].told(subject.cameras[i]));
  return coverages;
}

void show(const ViewpointSubject& subject, const Sight& sight, const Viewpoint& stop, std::vector<Shown>* shown) {
  const WorldCamera& seeing = subject.cameras[sight.camera];
  (*shown)[sight.camera].add(seeing.camera,
                             corners_in_image(seeing, stop.T_scene_robot(), subject.board_at(sight.board)));
}

void show_from(const std::vector<Rigid3>& T_scene_robot, const Places& places, const ViewpointSubject& subject,
               std::vector<Shown>* shown) {
  for (const Rigid3& T : T_scene_robot) {
    const Viewpoint stop = places.at(T.translation.x(), T.translation.y(), yaw_of(T));
    for (const Sight& sight : places.seeing(stop)) show(subject, sight, stop, shown);
  }
}

// Evenly from one end to the other; one number if they are one.
std::vector<double> spread(double low, double high, int count) {
  if (low == high) return {low};
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(low + (high - low) * i / (count - 1));
  return values;
}

// Evenly in the rows of an image, which go with the inverse of the distance.
std::vector<Viewpoint> places_around(const ViewpointConfig& config, const Places& places) {
  std::vector<Viewpoint> stops;
  const std::vector<double> bearings_deg = spread(config.bearing_deg.lowest(), config.bearing_deg.highest(), kBearings);
  for (const double inverse_m : spread(1.0 / config.distance_m.highest(), 1.0 / config.distance_m.lowest(), kDistances))
    for (const double bearing_deg : bearings_deg)
      for (std::size_t board = 0; board < places.boards(); ++board)
        for (int heading = 0; heading < kHeadings; ++heading)
          stops.push_back(
              places.place(1.0 / inverse_m, deg_to_rad(bearing_deg), 2.0 * kPi * heading / kHeadings, board));
  return stops;
}

}  // namespace

std::string describe_camera(const CameraCoverage& seen, const CameraCoverage& possible, std::size_t stops) {
  const auto rows = [](const CameraCoverage& coverage) {
    return fixed_text(coverage.top_row_px, 0) + " to " + fixed_text(coverage.bottom_row_px, 0);
  };
  std::string text = "board in " + std::to_string(seen.stops) + " of " + std::to_string(stops);
  if (possible.cells == 0) return text + ": from no place is it whole in the image";
  if (seen.cells == 0) return text + " (possible: " + std::to_string(possible.cells) + " parts of its image)";
  return text + ", in " + std::to_string(seen.cells) + " of " + std::to_string(kImageCells) +
         " parts of its image (possible: " + std::to_string(possible.cells) + "), rows " + rows(seen) + " of " +
         std::to_string(seen.rows) + " (possible: " + rows(possible) + ")";
}

std::vector<Eigen::Vector2d> corners_in_image(const WorldCamera& camera, const Rigid3& T_scene_robot,
                                              const ViewedBoard& board) {
  const Rigid3 T_camera_board = (T_scene_robot * camera.T_robot_camera).inverse() * board.T_scene_board;
  std::vector<Eigen::Vector2d> pixels;
  for (int id = 0; id < board.board.corner_count(); ++id) {
    Eigen::Vector2d pixel;
    if (camera.camera.project(T_camera_board * board.board.corner(id), &pixel)) pixels.push_back(pixel);
  }
  return pixels;
}

std::vector<CameraCoverage> coverage_of(const std::vector<Rigid3>& T_scene_robot, const ViewpointConfig& config,
                                        const ViewpointSubject& subject, ViewpointWorld& world) {
  std::vector<Shown> shown(subject.cameras.size());
  show_from(T_scene_robot, Places(config, subject, world), subject, &shown);
  return told(shown, subject);
}

std::vector<CameraCoverage> possible_coverage(const ViewpointConfig& config, const ViewpointSubject& subject,
                                              ViewpointWorld& world, const std::vector<Rigid3>& T_scene_robot) {
  const Places places(config, subject, world);
  std::vector<Shown> shown(subject.cameras.size());
  show_from(T_scene_robot, places, subject, &shown);
  for (const Viewpoint& stop : places_around(config, places)) {
    if (!places.inside(stop)) continue;
    for (const Sight& sight : places.facing(stop)) show(subject, sight, stop, &shown);
  }
  return told(shown, subject);
}

}  // namespace rigproof

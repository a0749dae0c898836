#include "dead_odometry.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "rigproof/core/rigid3.h"

namespace rigproof::ml {
namespace {

// What a camera on a robot cannot mistake for standing still [m + rad], and the share of it that odometry which stands
// may show: noise of a pose that is filtered or rounded.
constexpr double kSeen = 0.05, kStill = 0.02;
constexpr double kConstant = 1e-5;  // of a column [m, rad]
// One in so many is a slip.
constexpr int kMany = 5;

double seen_motion(const ViewPair& pair) {
  const Rigid3 motion = pair.from->T_camera_board * pair.to->T_camera_board.inverse();
  return motion.translation.norm() + std::abs(Eigen::AngleAxisd(motion.rotation).angle());
}

double odometry_motion(const Stop& from, const Stop& to) {
  return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) + std::abs(wrap_angle(to.yaw_rad - from.yaw_rad));
}

// A way between two stops that a camera saw, and whether the odometry stood on it.
struct SeenMotion {
  int from = -1;
  bool still = false;
};

// By the stop at which they end. A camera that missed a stop saw the way past it, which is no further motion: of those
// that end at one stop the shortest counts.
std::map<int, SeenMotion> seen_motions(const Observations& observations, const std::vector<ViewPose>& views) {
  std::map<int, SeenMotion> motions;
  for (int camera = 0; camera < static_cast<int>(observations.cameras.size()); ++camera)
    for (const ViewPair& pair : consecutive_pairs(views, camera)) {
      const auto from = static_cast<std::size_t>(pair.from->stop), to = static_cast<std::size_t>(pair.to->stop);
      const double seen = seen_motion(pair), told = odometry_motion(observations.stops[from], observations.stops[to]);
      if (seen <= kSeen) continue;
      SeenMotion& motion = motions[pair.to->stop];
      if (pair.from->stop >= motion.from) motion = {pair.from->stop, told < kStill * seen};
    }
  return motions;
}

double range_of(const std::vector<Stop>& stops, double Stop::*column) {
  const auto [least, most] = std::minmax_element(
      stops.begin(), stops.end(), [column](const Stop& a, const Stop& b) { return a.*column < b.*column; });
  return (*most).*column - (*least).*column;
}

// As they were recorded.
std::string constant_columns(std::vector<Stop> stops, const Eigen::Vector2d& rotation_centre_m) {
  for (Stop& stop : stops) {
    const Eigen::Vector3d recorded = odometry_of_point({stop.x_m, stop.y_m, stop.yaw_rad}, rotation_centre_m);
    stop.x_m = recorded.x();
    stop.y_m = recorded.y();
  }
  std::string names;
  const auto look = [&](double Stop::*column, const char* name) {
    if (range_of(stops, column) < kConstant) names += (names.empty() ? "" : " and ") + std::string(name);
  };
  look(&Stop::x_m, "x");
  look(&Stop::y_m, "y");
  look(&Stop::yaw_rad, "yaw");
  return names;
}

}  // namespace

std::optional<Finding> find_dead_odometry(const Observations& observations, const std::vector<ViewPose>& views,
                                          bool contradicted) {
  const std::map<int, SeenMotion> motions = seen_motions(observations, views);
  const auto still =
      std::count_if(motions.begin(), motions.end(), [](const auto& motion) { return motion.second.still; });
  if (still > 1 && kMany * still > static_cast<std::ptrdiff_t>(motions.size()))
    return Finding("odometry.dead", {{"still", still}, {"motions", motions.size()}});
  if (!contradicted || motions.size() < 3) return std::nullopt;
  const std::string columns = constant_columns(observations.stops, observations.odometry_noise.rotation_centre_m);
  if (columns.empty()) return std::nullopt;
  return Finding("odometry.constant", {{"columns", columns}});
}

}  // namespace rigproof::ml

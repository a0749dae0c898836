// RobotAutocalib with the board's motions and the planes of the depth images.
#include "rigproof/calib/diagnose/method.h"
#include "rival_result.h"
#include "robot_autocalib.h"

namespace rigproof {
namespace {

using rivals::AutocalibResult;
using rivals::AutocalibSensor;

// Rays of an image along which an observed plane is turned back into points.
constexpr int kGridColumns = 16, kGridRows = 9;

// Points of the plane a . p = 1 where the camera's image and its sensor's range show it.
void add_plane_points(const RigCamera& camera, const PlaneObservation& plane, std::vector<Eigen::Vector3d>* points) {
  for (int row = 0; row < kGridRows; ++row) {
    for (int column = 0; column < kGridColumns; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * camera.camera.width_px / kGridColumns - 0.5,
                                  (row + 0.5) * camera.camera.height_px / kGridRows - 0.5);
      Eigen::Vector3d ray;
      if (!camera.camera.unproject(pixel, &ray)) continue;
      const double inverse_depth = plane.inverse_depth_plane.dot(ray);
      const double depth = 1.0 / inverse_depth;
      const double min = camera.depth ? camera.depth->min_m : 0.1, max = camera.depth ? camera.depth->max_m : 10.0;
      if (inverse_depth > 0.0 && depth >= min && depth <= max) points->push_back(depth * ray);
    }
  }
}

std::vector<AutocalibSensor> sensors_from_board(const Observations& observations, const std::vector<ViewPose>& views) {
  std::vector<AutocalibSensor> sensors;
  const std::vector<Rigid3> odometry = odometry_poses(observations);
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    AutocalibSensor sensor;
    sensor.name = observations.cameras[k].name;
    sensor.metric_ground = true;
    for (const ViewPair& pair : consecutive_pairs(views, static_cast<int>(k))) {
      const Rigid3& from = odometry[static_cast<std::size_t>(pair.from->stop)];
      const Rigid3& to = odometry[static_cast<std::size_t>(pair.to->stop)];
      sensor.motions.push_back({pair.from->stop, pair.to->stop, from.inverse() * to,
                                pair.from->T_camera_board * pair.to->T_camera_board.inverse()});
    }
    for (const PlaneObservation& plane : observations.ground_planes)
      if (plane.camera == static_cast<int>(k)) add_plane_points(observations.cameras[k], plane, &sensor.ground_points);
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

rivals::UsedViews views_of_inliers(const std::vector<AutocalibSensor>& sensors, const AutocalibResult& found) {
  rivals::UsedViews used;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    if (!found.poses[k]) continue;
    for (std::size_t i = 0; i < sensors[k].motions.size(); ++i) {
      if (!found.poses[k]->inliers[i]) continue;
      used.insert({sensors[k].motions[i].from, static_cast<int>(k)});
      used.insert({sensors[k].motions[i].to, static_cast<int>(k)});
    }
  }
  return used;
}

// RobotAutocalib with the motions of the board and the planes of the depth images.
class RobotAutocalibBoard : public Method {
 public:
  MethodTraits traits() const override {
    return {"robot_autocalib_board",
            "RobotAutocalib (Zuniga-Noel et al. 2019) on the board's motions and the depth images' planes",
            "board, odometry, ground plane of every camera",
            "camera to robot (6), camera to camera",
            MethodReads::kObservations,
            6e-5};
  }

  std::optional<Finding> why_not(const MethodInput& input) const override {
    if (!input.observations.ground_planes.empty()) return {};
    return Finding("method.no_ground_plane");
  }

  Result solve(const Observations& observations) const override {
    const ViewPoses views = estimate_view_poses(observations);
    const std::vector<AutocalibSensor> sensors = sensors_from_board(observations, views.poses);
    const AutocalibResult found = rivals::robot_autocalib(sensors);
    Result result = rivals::result_of(observations, sensors, found);
    result.method = traits().name;
    rivals::report_use(observations, views.poses, views_of_inliers(sensors, found), Finding("view.off_odometry"),
                       &result);
    return result;
  }
};

}  // namespace

std::vector<const Method*> robot_autocalib_board_methods() {
  static const RobotAutocalibBoard method;
  return {&method};
}

}  // namespace rigproof

// A small recording, observations, result and truth that every test of the formats on disk can start from.
#pragma once

#include "random_values.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"
#include "rigproof/core/run_folder.h"

namespace rigproof {

inline RigCamera sample_camera(RandomStream& random, const std::string& name, Lens lens) {
  RigCamera camera;
  camera.name = camera.folder = name;
  camera.link = name + "_link";
  camera.sensor = "d455";
  camera.camera = random_camera(random, lens);
  camera.depth = DepthStream();
  camera.depth->noise.scale_sigma = random.uniform(0.001, 0.01);
  if (lens == Lens::kBrownConrady) camera.depth->noise.bias_inverse_depth_per_m = 0.001;
  return camera;
}

inline Rig sample_rig() {
  RandomStream random(1, "sample rig");
  Rig rig;
  rig.name = "monday";
  rig.robot_frame = "base_footprint";
  rig.board.square_m = 0.11;
  rig.board.squares_x = 6;
  rig.board.squares_y = 5;
  rig.cameras = {sample_camera(random, "left", Lens::kPinhole), sample_camera(random, "center", Lens::kBrownConrady),
                 sample_camera(random, "right", Lens::kKannalaBrandt)};
  rig.cameras[0].depth->own_camera =
      DepthStream::OwnCamera{random_camera(random, Lens::kBrownConrady), random_transform(random, 0.1, 0.1)};
  rig.cameras[0].intrinsics_sigma = IntrinsicsSigma::exact();
  rig.cameras[1].intrinsics_sigma.focal_relative = 0.001;
  rig.board.square_sigma_m = 0.0001;
  rig.cameras[2].depth.reset();
  rig.cameras[2].sensor.clear();
  rig.cameras[1].readout_s = 0.02;
  rig.cameras[1].readout_sigma_s = 0.001;
  rig.cameras[1].clock_offset_sigma_s = 0.005;
  rig.odometry_noise = {OdometryModel::kPerIncrement,
                        0.002,
                        deg_to_rad(0.57),
                        0.005,
                        0.001,
                        {0.13, -0.0025},
                        0.02,
                        0.03,
                        deg_to_rad(0.5),
                        0.005};
  rig.accept = AcceptLimits{0.008, 0.004, deg_to_rad(0.2)};
  return rig;
}

/// Files are named, not written.
inline Recording sample_recording(const std::filesystem::path& folder) {
  RandomStream random(2, "sample recording");
  Recording recording;
  recording.folder = folder;
  recording.rig = sample_rig();
  for (int i = 0; i < 5; ++i)
    recording.odometry.push_back({i + random.uniform(), random.normal(), random.normal(), random.normal()});
  for (const RigCamera& camera : recording.rig.cameras) {
    std::vector<CameraFrame> frames;
    for (int i = 0; i < 3; ++i) {
      CameraFrame frame;
      frame.color_file = camera.folder + "/color/00000" + std::to_string(i) + ".png";
      if (camera.depth) frame.depth_file = camera.folder + "/depth/00000" + std::to_string(i) + ".png";
      frame.stamp_s = i + random.uniform();
      frame.exposure_s = 0.005;
      frame.line = i + 2;
      frames.push_back(frame);
    }
    recording.frames.push_back(frames);
  }
  return recording;
}

inline Eigen::MatrixXd random_covariance(RandomStream& random, int size, double sigma) {
  Eigen::MatrixXd A(size, size + 2);
  for (Eigen::Index i = 0; i < A.size(); ++i) A.data()[i] = random.normal(0.0, sigma);
  return A * A.transpose();
}

inline PlaneObservation sample_plane(RandomStream& random, int stop, int camera) {
  PlaneObservation plane;
  plane.stop = stop;
  plane.camera = camera;
  plane.file = "left/depth/000000.png";
  plane.inverse_depth_plane = random_vector(random, 2.0);
  const Eigen::Matrix3d c = random_covariance(random, 3, 1e-3);
  plane.covariance_per_m2 = 0.5 * (c + c.transpose());
  plane.effective_points = random.uniform(100.0, 1000.0);
  plane.inlier_points = 12345;
  plane.residual_rms = random.uniform(0.8, 1.2);
  return plane;
}

inline Observations sample_observations() {
  RandomStream random(3, "sample observations");
  const Rig rig = sample_rig();
  Observations o;
  o.source = "runs/\"demo\"\n\xc3\xa4";
  o.robot_frame = rig.robot_frame;
  o.board = rig.board;
  o.cameras = rig.cameras;
  o.odometry_noise = rig.odometry_noise;
  o.accept = rig.accept;
  for (int stop = 0; stop < 2; ++stop) {
    o.stops.push_back({stop + random.uniform(), random.normal(), random.normal(), random.normal(), 0.0});
    if (stop > 0) o.stops.back().way = {random_vector(random, 3.0), random_vector(random, 3.0)};
    if (stop > 0) o.stops.back().velocity << 0.31, -0.02, 0.17;
    if (stop > 0) o.stops.back().acceleration << 0.9, 0.1, -2.5;
    for (int camera = 0; camera < 2; ++camera) {
      BoardView view;
      view.stop = stop;
      view.camera = camera;
      view.stamp_s = stop + 0.1;
      view.file = "left/color/000000.png";
      for (const int id : {0, 1, 5, 19}) {
        CornerObservation corner;
        corner.id = id;
        corner.pixel << random.uniform(0.0, 1279.0), random.uniform(0.0, 719.0);
        const Eigen::Matrix2d c = random_covariance(random, 2, 0.01);
        corner.covariance_px2 = 0.5 * (c + c.transpose());
        view.corners.push_back(corner);
      }
      o.board_views.push_back(view);
      o.ground_planes.push_back(sample_plane(random, stop, camera));
    }
    o.board_planes.push_back(sample_plane(random, stop, 0));
  }
  o.exclusions.push_back({1, 0, "center/color/000003.png", Finding("board.cut_off")});
  o.exclusions.push_back(
      {2, -1, "right/color/000004.png", Finding("odometry.gap", {{"gap_s", 2.5}, {"from_s", 1.0}, {"to_s", 3.5}})});
  return o;
}

inline Result sample_result() {
  RandomStream random(4, "sample result");
  Result result;
  result.method = "ml";
  result.status = ResultStatus::kSolved;
  result.reasons = {Finding("odometry.unit", {{"unit", "feet"}, {"undone_mm", 0.1}}),
                    Finding("camera.no_pose", {{"images", 2}, {"remedy", "aim"}})
                        .of("right")
                        .by({Finding("board.not_found", {{"count", 2}})})};
  result.notes = {Finding("odometry.row_contradicts", {{"stamp_s", 14.0}, {"off_cm", 1.0 / 3.0}}).at({7}),
                  Finding("moved.open_motions").along({"x", "yaw"}), stated("3.5", Severity::kNote)};
  for (const char* child : {"left", "center"}) {
    EstimatedTransform transform{"base_footprint", child, random_transform(random), {}, {}};
    transform.observable.fill(true);
    transform.covariance = random_covariance(random, 6, 1e-3);
    result.camera_to_robot.push_back(transform);
  }
  EstimatedTransform pair{"left", "center", random_transform(random), {}, {}};
  pair.observable.fill(true);
  result.camera_to_camera.push_back(pair);
  result.joint_covariance = random_covariance(random, 12, 1e-3);
  result.use = {{"left", 22, {{0, 3, "left/color/000003.png", Finding("board.cut_off")}}, 0.0321},
                {"center", 23, {}, 0.0456}};
  result.residuals = {{"corners", "px", 1234, 0.05}, {"odometry", "sigma", 69, 1.01}};
  result.camera_to_robot[0].budget = {{"corners", {0.25, 0.5, 0.125, 1.0, 0.75, 0.0}},
                                      {"board", {0.75, 0.5, 0.875, 0.0, 0.25, 1.0}}};
  result.rotation_centre_m << -0.0625, 0.0031;
  result.rotation_centre_sigma_m = 0.015;
  LastingErrors& lasting = result.lasting.emplace();
  lasting.unknowns.resize(2);
  lasting.unknowns[0] = {{"left", 0}, "focal_length_percent", -0.31};
  lasting.unknowns[1] = {{"", 1}, "board_size_percent", 0.125};
  lasting.covariance = Eigen::Matrix2d{{0.04, -0.0125}, {-0.0125, 0.25}};
  lasting.with_cameras = Eigen::MatrixXd::Constant(12, 2, 6.25e-9);
  lasting.fine_fields = {{"center", 12, 0.25, 0.5}};
  lasting.stated.resize(2);
  lasting.stated[0] = {{"left", 0}, "0123456789abcdef"};
  lasting.stated[1] = {{"", 1}, "fedcba9876543210"};
  result.boards = {{3, Rigid3(rotation_z(0.5), {2.1, -0.25, -1.5}), {0.001, 0.002, 0.003, 0.0004, 0.0005, 0.0006}}};
  result.lenses = {{"left", Camera::symmetric(1280, 720, 640.0)}};
  result.also_estimated = {{"left", "focal_length_percent", -0.31, 0.02, 0.5},
                           {"center", "clock_offset_ms", 4.5, 0.7, 10.0}};
  return result;
}

inline Manifest sample_manifest() {
  Manifest manifest;
  manifest.tool_version = "0.1.0";
  manifest.gl_renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  manifest.mujoco_version = "2.2.2";
  manifest.config_sha256 = std::string(64, 'a');
  manifest.files["recording/left/color/000000.png"] = {123456789012ULL, std::string(64, '0')};
  manifest.files["recording/rig.yaml"] = {5, std::string(64, 'f')};
  return manifest;
}

}  // namespace rigproof

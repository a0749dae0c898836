// What the tests of exports write: three cameras of three lenses, one of them with intrinsics that were estimated.
#pragma once

#include "random_values.h"
#include "rigproof/study/export/export.h"

namespace rigproof {

inline EstimatedTransform pose_of(const std::string& camera, const Rigid3& T) {
  EstimatedTransform estimate{
      "base_footprint", camera, T, Matrix6d::Identity(), {true, true, true, true, true, true}, {}};
  *estimate.covariance *= 1e-6;
  return estimate;
}

inline RigCamera rig_camera(const std::string& name, const std::string& link, const Camera& lens) {
  RigCamera camera;
  camera.name = name;
  camera.link = link;
  camera.camera = lens;
  return camera;
}

/// left: link of its own (body axes), Brown-Conrady with k3; front: an optical link, pinhole; rear: the driver's tree
/// is known, fisheye.
struct ExportSample {
  Result result;
  RigFacts rig;
  Rigid3 T_link_rear;  ///< what the driver publishes

  ExportSample() {
    RandomStream random(3, "export");
    result.method = "ml";
    result.status = ResultStatus::kSolved;
    for (const char* name : {"left", "front", "rear"})
      result.camera_to_robot.push_back(pose_of(name, random_transform(random)));
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = j + 1; k < 3; ++k) {
        EstimatedTransform pair =
            pose_of(result.camera_to_robot[k].child,
                    result.camera_to_robot[j].T_parent_child.inverse() * result.camera_to_robot[k].T_parent_child);
        pair.parent = result.camera_to_robot[j].child;
        result.camera_to_camera.push_back(pair);
      }
    rig.source = "rig.yaml";
    rig.cameras = {rig_camera("left", "left_link", random_camera(random, Lens::kBrownConrady)),
                   rig_camera("front", "front_optical_frame", random_camera(random, Lens::kPinhole)),
                   rig_camera("rear", "rear_link", random_camera(random, Lens::kKannalaBrandt))};
    T_link_rear = random_transform(random, 0.1);
    Camera estimated = rig.cameras[0].camera;
    estimated.fx_px += 2.0;
    estimated.distortion[4] = 0.001;
    result.lenses = {{"left", estimated}};
  }

  ExportJob job(ExportOptions options = {}) const {
    options.result_file = "monday/results/ml.yaml";
    options.date = "2030-01-02";
    if (options.optical_frames.count("rear") == 0) options.T_link_camera.emplace("rear", T_link_rear);
    return prepare_export(result, rig, options);
  }
  const Rigid3& T_robot(std::size_t camera) const { return result.camera_to_robot[camera].T_parent_child; }
};

/// The text of a format with one file.
inline std::string exported(const ExportJob& job, const std::string& format) {
  return write_export(job, export_format(format)).files.at(0).text;
}

/// Links that hang below each other, as the sample's tree: with what each format says, p of every camera in the robot.
struct TreeOfFrames {
  struct Edge {
    std::string parent;
    Rigid3 T;
  };
  std::map<std::string, Edge> edges;

  void add(const std::string& parent, const std::string& child, const Rigid3& T) {
    if (!edges.emplace(child, Edge{parent, T}).second) throw std::runtime_error(child + " has two parents");
  }
  Rigid3 T_robot(const std::string& frame) const {
    const auto found = edges.find(frame);
    return found == edges.end() ? Rigid3() : T_robot(found->second.parent) * found->second.T;
  }
};

}  // namespace rigproof

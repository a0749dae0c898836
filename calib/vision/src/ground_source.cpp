#include "rigproof/calib/vision/ground_source.h"

#include <algorithm>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/vision/image_ground.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr int kMinPlanes = 3;
constexpr int kViewsPerPlane = 5;
// What all heights of a camera that are triangulated have wrong in common, as a share: 0.06 % was seen in `home`.
constexpr double kHeightScaleSigma = 0.001;

template <typename Items>
int count_of(const Items& items, int camera) {
  return static_cast<int>(
      std::count_if(items.begin(), items.end(), [camera](const auto& item) { return item.camera == camera; }));
}

void drop_planes(std::vector<PlaneObservation>* planes, int camera) {
  planes->erase(std::remove_if(planes->begin(), planes->end(),
                               [camera](const PlaneObservation& plane) { return plane.camera == camera; }),
                planes->end());
}

bool before(const PlaneObservation& a, const PlaneObservation& b) {
  return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera;
}

std::vector<int> cameras_by_images(GroundSource source, const Observations& observations) {
  if (source == GroundSource::kAuto) return cameras_without_trusted_depth(observations);
  std::vector<int> cameras;
  for (std::size_t k = 0; source == GroundSource::kImages && k < observations.cameras.size(); ++k)
    cameras.push_back(static_cast<int>(k));
  return cameras;
}

}  // namespace

const std::vector<std::string>& ground_source_names() {
  static const std::vector<std::string> names = {"depth", "images", "auto"};
  return names;
}

GroundSource ground_source_by_name(const std::string& name) {
  const std::vector<std::string>& names = ground_source_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw Error("ground: \"" + for_message(name) + "\": " + suggestion(name, names));
  return static_cast<GroundSource>(found - names.begin());
}

std::vector<int> cameras_without_trusted_depth(const Observations& observations) {
  const TrajectoryAlignment alignment = align_trajectories(observations, estimate_view_poses(observations).poses);
  const GroundCheck check = check_ground_planes(observations, alignment);
  std::vector<int> cameras;
  for (std::size_t k = 0; k < observations.cameras.size(); ++k) {
    const int camera = static_cast<int>(k), planes = check.count(observations, camera);
    if (planes < kMinPlanes || kViewsPerPlane * planes < count_of(observations.board_views, camera))
      cameras.push_back(camera);
  }
  return cameras;
}

GroundReport take_ground_from(GroundSource source, const MethodInput& input, Observations* observations) {
  GroundReport report;
  if (source == GroundSource::kDepth || input.recording == nullptr) return report;
  const std::vector<int> cameras = cameras_by_images(source, *observations);
  if (cameras.empty()) return report;
  Observations without = *observations;
  for (const int camera : cameras) drop_planes(&without.ground_planes, camera);
  const rivals::Features features(input);
  const MethodInput images{without, input.recording, input.threads, nullptr,
                           nullptr, input.progress,  input.memory,  input.keep_going};
  const ImageGround ground = ground_from_images(images, features.source());
  for (const int camera : cameras) {
    const std::string& name = observations->cameras[static_cast<std::size_t>(camera)].name;
    const int found = count_of(ground.planes, camera), had = count_of(observations->ground_planes, camera);
    if (found == 0 && source == GroundSource::kAuto) {
      report.findings.push_back(
          Finding("ground.not_in_images", had > 0 ? FindingValues{{"of_depth", had}} : FindingValues()).of(name));
      continue;
    }
    report.cameras.push_back(camera);
    drop_planes(&observations->ground_planes, camera);
    drop_planes(&observations->board_planes, camera);
    std::optional<DepthStream>& depth = observations->cameras[static_cast<std::size_t>(camera)].depth;
    depth = DepthStream();
    depth->noise.scale_sigma = kHeightScaleSigma;
    depth->noise.believe_place_and_common_scale();
    for (const PlaneObservation& plane : ground.planes)
      if (plane.camera == camera) observations->ground_planes.push_back(plane);
    for (const Exclusion& exclusion : ground.rejected)
      if (exclusion.camera == camera) observations->exclusions.push_back(exclusion);
    const Finding taken = Finding("ground.from_images", {{"planes", found}}).of(name);
    report.findings.push_back(had > 0 ? taken.with({{"instead_of", had}}) : taken);
  }
  std::stable_sort(observations->ground_planes.begin(), observations->ground_planes.end(), before);
  return report;
}

}  // namespace rigproof

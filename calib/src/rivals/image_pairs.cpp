#include "rivals/image_pairs.h"

#include <map>

#include "detection/parallel.h"
#include "rigproof/calib/image_io.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rivals/image_files.h"

namespace rigproof::rivals {
namespace {

struct FeatureRays {
  ImageFeatures features;
  std::vector<Eigen::Vector3d> rays;
};

// Features whose pixel has a ray; none where the image cannot be read.
FeatureRays read_features(const Recording& recording, const CameraFrame& frame, const Camera& camera,
                          const FeatureSource& source) {
  FeatureRays result;
  try {
    const auto read = read_grey_image(path_inside(recording.folder, frame.color_file));
    const Image8* image = std::get_if<Image8>(&read);
    if (image == nullptr || image->width != camera.width_px || image->height != camera.height_px) return result;
    result.features = source.detect(*image);
  } catch (const Error&) {
    return FeatureRays();
  }
  for (const Eigen::Vector2d& pixel : result.features.pixels) {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();
    if (!camera.unproject(pixel, &ray)) ray.setZero();
    result.rays.push_back(ray);
  }
  return result;
}

std::vector<RayMatch> match(const FeatureRays& a, const FeatureRays& b) {
  std::vector<RayMatch> matches;
  for (const auto& [i, j] : match_features(a.features, b.features))
    if (a.rays[i].z() > 0.0 && b.rays[j].z() > 0.0) matches.push_back({a.rays[i], b.rays[j]});
  return matches;
}

}  // namespace

std::vector<ImagePair> match_consecutive_images(const MethodInput& input, const FeatureSource& source,
                                                const std::function<bool(int, int, int)>& wanted) {
  std::vector<ImagePair> pairs;
  if (input.recording == nullptr) return pairs;
  const FramesByStop frames = frames_by_stop(input.observations, *input.recording);
  std::map<int, std::vector<int>> stops;
  for (const auto& [key, frame] : frames) stops[key.second].push_back(key.first);
  std::map<std::pair<int, int>, FeatureRays> features;  // of the images that a wanted step needs
  for (const auto& [camera, list] : stops) {
    for (std::size_t i = 1; i < list.size(); ++i) {
      if (!wanted(camera, list[i - 1], list[i])) continue;
      pairs.push_back({camera, list[i - 1], list[i], {}});
      features[{list[i - 1], camera}];
      features[{list[i], camera}];
    }
  }
  std::vector<std::pair<const std::pair<int, int>, FeatureRays>*> jobs;
  for (auto& job : features) jobs.push_back(&job);
  detection::for_each_parallel(jobs.size(), input.threads, [&](std::size_t i) {
    const auto& [stop, camera] = jobs[i]->first;
    jobs[i]->second = read_features(*input.recording, *frames.at({stop, camera}),
                                    input.observations.cameras[static_cast<std::size_t>(camera)].camera, source);
  });
  detection::for_each_parallel(pairs.size(), input.threads, [&](std::size_t i) {
    ImagePair& pair = pairs[i];
    pair.matches = match(features.at({pair.from, pair.camera}), features.at({pair.to, pair.camera}));
  });
  return pairs;
}

double ray_sigma(const Camera& camera, double sigma_px) { return sigma_px / camera.fx_px; }

}  // namespace rigproof::rivals

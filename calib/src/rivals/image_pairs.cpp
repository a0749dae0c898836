#include "rivals/image_pairs.h"

#include <algorithm>
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

// Features of every image once, then the matches of every pair; neither depends on the order of the work.
void match_images(const MethodInput& input, const FeatureSource& source, std::vector<ImagePair>* pairs) {
  std::map<const CameraFrame*, std::pair<int, FeatureRays>> features;
  for (const ImagePair& pair : *pairs) features[pair.image_from].first = features[pair.image_to].first = pair.camera;
  std::vector<std::pair<const CameraFrame* const, std::pair<int, FeatureRays>>*> jobs;
  for (auto& job : features) jobs.push_back(&job);
  const auto read = [&](std::size_t i) {
    const auto camera = static_cast<std::size_t>(jobs[i]->second.first);
    jobs[i]->second.second =
        read_features(*input.recording, *jobs[i]->first, input.observations.cameras[camera].camera, source);
  };
  for_each_image(input, jobs.size(), read);
  detection::for_each_parallel(pairs->size(), input.threads, [&](std::size_t i) {
    ImagePair& pair = (*pairs)[i];
    pair.matches = match(features.at(pair.image_from).second, features.at(pair.image_to).second);
  });
}

// Frames of a camera in a segment, where they lie in the recording.
std::vector<const CameraFrame*> segment_frames(const Recording& recording, const RecordingSegment& segment,
                                               std::size_t camera) {
  std::vector<const CameraFrame*> frames;
  for (const CameraFrame& frame : recording.frames[camera])
    if (segment.holds(frame.stamp_s)) frames.push_back(&frame);
  return frames;
}

}  // namespace

void for_each_image(const MethodInput& input, std::size_t count, const std::function<void(std::size_t)>& work) {
  std::function<bool(std::size_t)> proceed;
  if (input.progress) proceed = [&](std::size_t done) { return input.progress(done, count); };
  if (!detection::for_each_parallel(count, input.threads, work, proceed))
    throw Error("interrupted", ExitCode::kTryAgain);
}

std::vector<ImagePair> match_consecutive_images(const MethodInput& input, const FeatureSource& source,
                                                const std::function<bool(int, int, int)>& wanted) {
  std::vector<ImagePair> pairs;
  if (input.recording == nullptr) return pairs;
  const FramesByStop frames = frames_by_stop(input.observations, *input.recording);
  std::map<int, std::vector<int>> stops;
  for (const auto& [key, frame] : frames) stops[key.second].push_back(key.first);
  for (const auto& [camera, list] : stops)
    for (std::size_t i = 1; i < list.size(); ++i)
      if (wanted(camera, list[i - 1], list[i]))
        pairs.push_back(
            {camera, list[i - 1], list[i], {}, frames.at({list[i - 1], camera}), frames.at({list[i], camera})});
  match_images(input, source, &pairs);
  return pairs;
}

std::vector<ImagePair> match_straight_segments(const MethodInput& input, const FeatureSource& source) {
  std::vector<ImagePair> pairs;
  if (input.recording == nullptr) return pairs;
  for (const RecordingSegment& segment : input.recording->segments) {
    for (std::size_t k = 0; k < input.recording->frames.size() && segment.kind == kStraightSegment; ++k) {
      const std::vector<const CameraFrame*> frames = segment_frames(*input.recording, segment, k);
      for (std::size_t i = 1; i < frames.size(); ++i)
        pairs.push_back({static_cast<int>(k), -1, -1, {}, frames[i - 1], frames[i]});
    }
  }
  match_images(input, source, &pairs);
  return pairs;
}

std::vector<std::pair<int, const CameraFrame*>> straight_segment_images(const Recording& recording) {
  std::vector<std::pair<int, const CameraFrame*>> images;
  for (const RecordingSegment& segment : recording.segments)
    for (std::size_t k = 0; k < recording.frames.size() && segment.kind == kStraightSegment; ++k)
      for (const CameraFrame* frame : segment_frames(recording, segment, k))
        images.emplace_back(static_cast<int>(k), frame);
  return images;
}

std::size_t straight_segment_steps(const Recording& recording) {
  std::size_t most = 0;
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    std::size_t steps = 0;
    for (const RecordingSegment& segment : recording.segments) {
      const std::size_t frames = segment.kind == kStraightSegment ? segment_frames(recording, segment, k).size() : 0;
      steps += frames > 0 ? frames - 1 : 0;
    }
    most = std::max(most, steps);
  }
  return most;
}

double ray_sigma(const Camera& camera, double sigma_px) { return sigma_px / camera.fx_px; }

}  // namespace rigproof::rivals

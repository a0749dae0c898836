#include "rigproof/calib/vision/image_pairs.h"

#include <algorithm>
#include <map>

#include "rigproof/calib/vision/image_files.h"
#include "rigproof/calib/vision/image_findings.h"
#include "rigproof/calib/vision/parallel.h"
#include "rigproof/calib/vision/recall.h"
#include "rigproof/calib/vision/straight_drive.h"
#include "rigproof/core/error.h"

namespace rigproof::rivals {
namespace {

std::vector<PixelMatch> match(const ImageFeatures& a, const ImageFeatures& b) {
  std::vector<PixelMatch> matches;
  for (const auto& [i, j] : match_features(a, b)) matches.push_back({a.pixels[i], b.pixels[j]});
  return matches;
}

// Matches whose pixels have rays.
std::vector<RayMatch> rays_of(const std::vector<PixelMatch>& matches, const Camera& camera) {
  std::vector<RayMatch> rays;
  for (const PixelMatch& match : matches) {
    RayMatch ray;
    if (camera.unproject(match.a, &ray.a) && camera.unproject(match.b, &ray.b) && ray.a.z() > 0.0 && ray.b.z() > 0.0)
      rays.push_back(ray);
  }
  return rays;
}

// Matches of all pairs: those that the memory holds first, then features of every other image once and the matches of
// every other pair. Nothing depends on the order of the work.
class Matcher {
 public:
  Matcher(const MethodInput& input, const FeatureSource& source, std::vector<ImagePair>* pairs)
      : input_(input), source_(source), pairs_(*pairs), found_(pairs->size()) {}

  void run() {
    for (std::size_t i = 0; i < pairs_.size(); ++i) recall(i);
    std::vector<std::pair<const CameraFrame* const, Seen>*> images;
    for (auto& image : images_) images.push_back(&image);
    for_each_image(input_, images.size(), [&](std::size_t i) {
      const auto image = readable_image(*input_.recording, *images[i]->first, camera(images[i]->second.camera));
      if (image) images[i]->second.features = source_.detect(*image);
    });
    for_each_piece(input_, pairs_.size(), [this](std::size_t i) { finish(i); });
  }

 private:
  struct Seen {
    int camera = 0;
    std::optional<ImageFeatures> features;
  };

  const Camera& camera(int index) const { return input_.observations.cameras[static_cast<std::size_t>(index)].camera; }

  void recall(std::size_t i) {
    ImagePair& pair = pairs_[i];
    pair.key = key_of(pair);
    if (!pair.key.empty())
      if (const auto bytes = input_.memory->recall(PictureMemory::Finding::kMatches, pair.key)) {
        std::vector<PixelMatch> matches;
        if (read_bytes(*bytes, &matches)) found_[i] = std::move(matches);
      }
    if (found_[i]) return;
    images_[pair.image_from].camera = images_[pair.image_to].camera = pair.camera;
  }

  std::string key_of(const ImagePair& pair) const {
    const std::string a = detection::content_of(input_.memory, pair.image_from->color_file);
    const std::string b = detection::content_of(input_.memory, pair.image_to->color_file);
    const std::string source = source_.identity();
    return a.empty() || b.empty() || source.empty() ? std::string() : matches_key(source, a, b, camera(pair.camera));
  }

  void finish(std::size_t i) {
    ImagePair& pair = pairs_[i];
    if (!found_[i]) {
      const auto &a = images_.at(pair.image_from).features, &b = images_.at(pair.image_to).features;
      if (!a || !b) {
        pair.key.clear();
        return;
      }
      found_[i] = match(*a, *b);
      if (!pair.key.empty()) input_.memory->keep(PictureMemory::Finding::kMatches, pair.key, bytes_of(*found_[i]));
    }
    pair.matches = rays_of(*found_[i], camera(pair.camera));
  }

  const MethodInput& input_;
  const FeatureSource& source_;
  std::vector<ImagePair>& pairs_;
  std::vector<std::optional<std::vector<PixelMatch>>> found_;
  std::map<const CameraFrame*, Seen> images_;
};

// Stops at which each camera has an image, in order.
std::map<int, std::vector<int>> stops_by_camera(const FramesByStop& frames) {
  std::map<int, std::vector<int>> stops;
  for (const auto& [key, frame] : frames) stops[key.second].push_back(key.first);
  return stops;
}

// Frames of one camera in one straight segment, where they lie in the recording.
struct SegmentFrames {
  int camera;
  std::vector<const CameraFrame*> frames;
};

std::vector<SegmentFrames> straight_segments(const Recording& recording) {
  std::vector<SegmentFrames> all;
  for (const RecordingSegment& segment : recording.segments) {
    for (std::size_t k = 0; k < recording.frames.size() && segment.kind == kStraightSegment; ++k) {
      SegmentFrames& of_camera = all.emplace_back(SegmentFrames{static_cast<int>(k), {}});
      for (const CameraFrame& frame : recording.frames[k])
        if (segment.holds(frame.stamp_s)) of_camera.frames.push_back(&frame);
    }
  }
  return all;
}

}  // namespace

void for_each_image(const MethodInput& input, std::size_t count, const std::function<void(std::size_t)>& work) {
  const auto proceed = [&](std::size_t done) {
    return (!input.progress || input.progress(done, count)) && (!input.keep_going || input.keep_going());
  };
  if (!detection::for_each_parallel(count, input.threads, work, proceed))
    throw Error("interrupted", ExitCode::kTryAgain);
}

void for_each_piece(const MethodInput& input, std::size_t count, const std::function<void(std::size_t)>& work) {
  const auto proceed = [&](std::size_t) { return !input.keep_going || input.keep_going(); };
  if (!detection::for_each_parallel(count, input.threads, work, proceed))
    throw Error("interrupted", ExitCode::kTryAgain);
}

std::vector<ImagePair> match_images(const MethodInput& input, const FeatureSource& source,
                                    const std::function<StopPairs(int, const std::vector<int>&)>& choose) {
  std::vector<ImagePair> pairs;
  if (input.recording == nullptr) return pairs;
  const FramesByStop frames = frames_by_stop(input.observations, *input.recording);
  for (const auto& [camera, list] : stops_by_camera(frames))
    for (const auto& [from, to] : choose(camera, list))
      pairs.push_back({camera, from, to, {}, frames.at({from, camera}), frames.at({to, camera})});
  Matcher(input, source, &pairs).run();
  return pairs;
}

std::vector<ImagePair> match_consecutive_images(const MethodInput& input, const FeatureSource& source,
                                                const std::function<bool(int, int, int)>& wanted) {
  return match_images(input, source, [&wanted](int camera, const std::vector<int>& stops) {
    StopPairs pairs;
    for (std::size_t i = 1; i < stops.size(); ++i)
      if (wanted(camera, stops[i - 1], stops[i])) pairs.emplace_back(stops[i - 1], stops[i]);
    return pairs;
  });
}

std::vector<ImagePair> match_straight_segments(const MethodInput& input, const FeatureSource& source) {
  std::vector<ImagePair> pairs;
  if (input.recording == nullptr) return pairs;
  for (const auto& [camera, frames] : straight_segments(*input.recording))
    for (std::size_t i = 1; i < frames.size(); ++i) pairs.push_back({camera, -1, -1, {}, frames[i - 1], frames[i]});
  Matcher(input, source, &pairs).run();
  return pairs;
}

std::vector<std::pair<int, const CameraFrame*>> straight_segment_images(const Recording& recording) {
  std::vector<std::pair<int, const CameraFrame*>> images;
  for (const auto& [camera, frames] : straight_segments(recording))
    for (const CameraFrame* frame : frames) images.emplace_back(camera, frame);
  return images;
}

std::size_t straight_segment_steps(const Recording& recording) {
  std::size_t most = 0;
  std::map<int, std::size_t> steps;
  for (const auto& [camera, frames] : straight_segments(recording))
    if (!frames.empty()) most = std::max(most, steps[camera] += frames.size() - 1);
  return most;
}

std::size_t turning_steps(const Observations& observations, const Recording& recording) {
  std::size_t most = 0;
  for (const auto& [camera, stops] : stops_by_camera(frames_by_stop(observations, recording))) {
    std::size_t steps = 0;
    for (std::size_t i = 1; i < stops.size(); ++i) steps += step_between(observations, stops[i - 1], stops[i]).turns();
    most = std::max(most, steps);
  }
  return most;
}

std::optional<RelativePose> relative_pose_of(const MethodInput& input, const ImagePair& pair, double sigma_px) {
  throw_if_interrupted(input);
  const Camera& camera = input.observations.cameras[static_cast<std::size_t>(pair.camera)].camera;
  const double sigma = ray_sigma(camera, sigma_px);
  FoundMotion motion;
  const auto estimate = [&] {
    const std::optional<RelativePose> pose = estimate_relative_pose(pair.matches, sigma);
    motion = FoundMotion();
    if (!pose) return true;
    motion.T_a_b = pose->T_a_b;
    // The inliers stand in the order of the matches.
    std::size_t next = 0;
    for (const RayMatch& match : pair.matches) {
      const bool agrees =
          next < pose->inliers.size() && match.a == pose->inliers[next].a && match.b == pose->inliers[next].b;
      motion.agrees.push_back(agrees);
      next += agrees;
    }
    return true;
  };
  const std::string key = pair.key.empty() ? std::string() : motion_key(pair.key, camera, sigma);
  detection::recall_or(input.memory, PictureMemory::Finding::kMotions, key, &motion, estimate);
  if (motion.T_a_b && motion.agrees.size() != pair.matches.size()) estimate();  // a finding of something else
  if (!motion.T_a_b) return std::nullopt;
  RelativePose pose{*motion.T_a_b, {}};
  for (std::size_t i = 0; i < pair.matches.size(); ++i)
    if (motion.agrees[i]) pose.inliers.push_back(pair.matches[i]);
  return pose;
}

double ray_sigma(const Camera& camera, double sigma_px) { return sigma_px / camera.fx_px; }

}  // namespace rigproof::rivals

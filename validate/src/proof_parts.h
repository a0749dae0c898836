// The parts of the proof: corners, depth, and the images' noise.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/truth/stop_at.h"
#include "rigproof/validate/proof.h"

namespace rigproof::proof_detail {

/// What is proved of one camera; each part of the proof adds to what the others found.
struct Proved {
  CameraProof camera;
  std::vector<Finding> problems;
  std::vector<Finding> notes;
};

/// What the truth says of a sensor; 0 where it says nothing.
inline double label_of(const TrueCamera& camera, const char* name) {
  const auto found = camera.sensing.find(name);
  return found == camera.sensing.end() ? 0.0 : found->second;
}

/// Index of a camera in a list by its name.
template <typename Cameras>
std::optional<std::size_t> camera_named(const Cameras& cameras, const std::string& name) {
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (cameras[i].name == name) return i;
  return std::nullopt;
}

/// Of so many frames, how many are looked at: of n, that is every frame i * frames / n.
inline std::size_t frames_looked_at(std::size_t frames, const ProofOptions& options) {
  return options.max_depth_frames == 0 ? frames : std::min(frames, static_cast<std::size_t>(options.max_depth_frames));
}

/// The corners. `camera` indexes the truth's cameras, `observed_camera` those of the observations.
Proved prove_corners(const Observations& observations, const Truth& truth, std::size_t observed_camera,
                     std::size_t camera, const ProofOptions& options, Proved proved);

/// The depth. `recorded_camera` indexes the recording's cameras. Of several boards a depth image is compared on the one
/// that was found in the image taken with it: another one may be hidden.
Proved prove_depth(const Recording& recording, const Observations& observations, const Truth& truth,
                   std::size_t recorded_camera, std::size_t camera, const ProofOptions& options, Proved proved);

/// The noise of the images, where the truth says that it was simulated.
Proved prove_image(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                   const ProofOptions& options, Proved proved);

}  // namespace rigproof::proof_detail

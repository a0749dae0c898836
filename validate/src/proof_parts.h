// The parts of the proof: corners, depth, and the images' noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/truth/stop_at.h"
#include "rigproof/validate/proof.h"

namespace rigproof::proof_detail {

struct Findings {
  std::vector<std::string> problems;
  std::vector<std::string> notes;
};

/// Fills the corner part of `proof`. `camera` indexes the truth's cameras, `observed_camera` those of the observations.
Findings prove_corners(const Observations& observations, const Truth& truth, std::size_t observed_camera,
                       std::size_t camera, const ProofOptions& options, CameraProof* proof);

/// Fills the depth part. `recorded_camera` indexes the recording's cameras.
Findings prove_depth(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                     const ProofOptions& options, CameraProof* proof);

/// Fills in the noise of the images, where the truth says that it was simulated.
Findings prove_image(const Recording& recording, const Truth& truth, std::size_t recorded_camera, std::size_t camera,
                     const ProofOptions& options, CameraProof* proof);

}  // namespace rigproof::proof_detail

// A data set's own proof of its conventions: what was detected against what the truth projects to.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

struct CameraProof {
  std::string camera;
  std::size_t views = 0;
  std::size_t corners = 0;
  Eigen::Vector2d corner_bias_px = Eigen::Vector2d::Zero();  ///< mean of detected - projected
  Eigen::Vector2d corner_rms_px = Eigen::Vector2d::Zero();
  double corner_max_px = 0.0;
  std::size_t depth_pixels = 0;
  double depth_bias_mm = 0.0;  ///< depth image against ray-plane intersection on board and ground
  double depth_rms_mm = 0.0;
  double depth_max_mm = 0.0;
};

struct Proof {
  std::vector<CameraProof> cameras;
  bool passed = false;
  std::vector<std::string> problems;  ///< in words: "left: corners are half a pixel to the right"
};

Proof prove(const Recording& recording, const Observations& observations, const Truth& truth);
void save_proof(const Proof& proof, const std::filesystem::path& file);
Proof load_proof(const std::filesystem::path& file);

}  // namespace rigproof

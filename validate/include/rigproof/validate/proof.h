// A data set's own proof of its conventions: what was detected against what the truth projects to, and what was
// measured as depth against where the truth's rays meet the board and the ground.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// What is allowed. A corner's bias may reach 5 sigma of its mean plus a floor, its rms 3 times the stated sigma plus a
/// floor; depth residuals are whitened by the sensor's stated noise and the rounding to its unit.
struct ProofOptions {
  /// What rendering (0.012 px through a lens) and detection (0.006 px) leave together, with some room.
  double corner_bias_floor_px = 0.02;
  double corner_rms_floor_px = 0.04;
  /// Whitened depth residuals on the board: 1 is the stated noise; disparity rounding adds up to 39 % to it.
  double depth_max_rms_sigmas = 2.0;
  double depth_max_bias_sigmas = 0.5;
  int depth_stride_px = 8;    ///< every so many pixels in both directions
  int max_depth_frames = 25;  ///< of each camera, spread evenly; 0 = all of them, -1 = no depth and no image noise
};

/// Noise of depth pixels near one distance, measured on board and ground.
struct RealisedDepthNoise {
  double z_m = 0.0;              ///< within a tenth of it
  std::size_t pixels = 0;        ///< that have a measurement
  double stated_sigma_mm = 0.0;  ///< by the sensor's law, with the rounding to its unit
  double sigma_mm = 0.0;         ///< realised; from the median distance to the median, so that edges do not count
  double bias_mm = 0.0;          ///< realised; median of measured - expected
};

/// Noise of the images' pixels of about one light, measured within the squares of the board.
struct RealisedImageNoise {
  double electrons = 0.0;               ///< light, the median of the squares
  std::size_t samples = 0;              ///< pixels times colours
  double stated_sigma_electrons = 0.0;  ///< by the sensor's law (EMVA 1288), with the rounding to levels
  double sigma_electrons = 0.0;         ///< realised; from the median square, so that dirt does not count
};

struct CameraProof {
  std::string camera;
  std::size_t views = 0;
  std::size_t corners = 0;
  Eigen::Vector2d corner_bias_px = Eigen::Vector2d::Zero();  ///< mean of detected - projected
  Eigen::Vector2d corner_rms_px = Eigen::Vector2d::Zero();   ///< about zero, per axis
  double corner_max_px = 0.0;                                ///< largest distance
  double corner_bias_limit_px = 0.0;                         ///< what was allowed
  double corner_rms_limit_px = 0.0;
  std::size_t depth_frames = 0;
  std::size_t depth_pixels = 0;     ///< on board and ground
  double depth_ground_share = 0.0;  ///< of the pixels whose ray meets the ground: those that show it
  double depth_bias_mm = 0.0;       ///< depth image against ray-plane intersection, mean of measured - expected
  double depth_rms_mm = 0.0;
  double depth_max_mm = 0.0;
  double depth_rms_sigmas = 0.0;                ///< whitened, on the board
  double depth_valid_share = 0.0;               ///< of the pixels on the board: those with a measurement
  std::vector<RealisedDepthNoise> depth_noise;  ///< at the distances that occur, of 0.8, 1, 2 and 4 m
  std::vector<RealisedImageNoise> image_noise;  ///< the photon transfer curve, from dark to bright, where it occurs
};

struct Proof {
  std::vector<CameraProof> cameras;
  bool passed = false;
  std::vector<Finding> problems;  ///< what does not agree: proof.corners_shifted of left, ..
  std::vector<Finding> notes;     ///< what could not be proved: proof.no_view of right, ..
};

/// Where detected and projected corners, or measured and expected depth, disagree, tries the wrong conventions one by
/// one and names the one that explains it. Passed if there is no problem and at least one corner was compared.
/// Throws Error if the observations name a camera that the truth does not know, or a depth image cannot be read.
Proof prove(const Recording& recording, const Observations& observations, const Truth& truth,
            const ProofOptions& options = {});
void save_proof(const Proof& proof, const std::filesystem::path& file, const Wording& wording = {});
/// JSON Schema of truth/proof.yaml.
std::string proof_schema();

}  // namespace rigproof

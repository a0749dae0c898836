// What methods find in images and between them, and the bytes in which it is kept.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/vision/reference_cloud_plane.h"
#include "rigproof/calib/vision/reference_corners.h"
#include "rigproof/calib/vision/relative_pose.h"
#include "rigproof/core/rig.h"

namespace rigproof::rivals {

/// A feature in two images, in pixels.
struct PixelMatch {
  Eigen::Vector2d a, b;
};

/// The motion between two images, with the matches that agree: one flag for each match that it was found from.
struct FoundMotion {
  std::optional<Rigid3> T_a_b;
  std::vector<std::uint8_t> agrees;
};

/// The board in a camera, by the corners of reference_chessboards().
struct ReferencePose {
  Rigid3 T_camera_board;
  double squared_px = 0.0;  ///< squared reprojection error, mean over the corners
};

/// Findings to the bit.
std::string bytes_of(const std::vector<PixelMatch>& matches);
std::string bytes_of(const FoundMotion& motion);
std::string bytes_of(const std::optional<CloudPlane>& plane);
std::string bytes_of(const std::optional<ChessboardCorners>& corners);
std::string bytes_of(const std::optional<ReferencePose>& pose);
/// False if the bytes are no such finding.
bool read_bytes(const std::string& bytes, std::vector<PixelMatch>* matches);
bool read_bytes(const std::string& bytes, FoundMotion* motion);
bool read_bytes(const std::string& bytes, std::optional<CloudPlane>* plane);
bool read_bytes(const std::string& bytes, std::optional<ChessboardCorners>* corners);
bool read_bytes(const std::string& bytes, std::optional<ReferencePose>* pose);

/// Hashes of all that a finding depends on.
/// @param source FeatureSource::identity()
/// @param content_a, content_b of the two images
std::string matches_key(const std::string& source, const std::string& content_a, const std::string& content_b,
                        const Camera& camera);
std::string motion_key(const std::string& matches, const Camera& camera, double sigma);
std::string cloud_key(const std::string& content, const RigCamera& camera, int points);
std::string chessboard_key(const std::string& content, const Camera& camera, const Board& board);
std::string reference_pose_key(const ChessboardCorners& corners, const Camera& camera, const Board& board);

}  // namespace rigproof::rivals

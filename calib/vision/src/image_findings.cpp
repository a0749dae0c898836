#include "rigproof/calib/vision/image_findings.h"

#include "finding_bytes.h"
#include "rigproof/core/files.h"

namespace rigproof::rivals {
namespace {

using detection::bytes_of_parts;
using detection::read_parts;
using detection::Writer;

// Raised whenever what is found, or these bytes, change.
constexpr std::uint32_t kFormat = 2;

Writer key_of(const char* kind) {
  Writer key(kFormat);
  key.kind(kind);
  return key;
}

constexpr auto kMatchesParts = [](auto& archive, auto& matches) {
  archive.kind("matches");
  archive.size(matches, sizeof(PixelMatch));
  for (auto& match : matches) {
    archive.matrix(match.a);
    archive.matrix(match.b);
  }
};

constexpr auto kMotionParts = [](auto& archive, auto& motion) {
  archive.kind("motion");
  if (archive.present(motion.T_a_b)) detection::kTransformParts(archive, *motion.T_a_b);
  archive.size(motion.agrees, 1);
  for (auto& agrees : motion.agrees) archive.number(agrees);
};

constexpr auto kPlaneParts = [](auto& archive, auto& plane) {
  archive.kind("cloud plane");
  if (!archive.present(plane)) return;
  archive.matrix(plane->normal);
  archive.number(plane->d);
};

constexpr auto kChessboardParts = [](auto& archive, auto& corners) {
  archive.kind("chessboard");
  if (!archive.present(corners)) return;
  archive.size(corners->pixels, sizeof(Eigen::Vector2f));
  for (auto& corner : corners->pixels) archive.matrix(corner);
};

constexpr auto kReferencePoseParts = [](auto& archive, auto& pose) {
  archive.kind("reference pose");
  if (!archive.present(pose)) return;
  detection::kTransformParts(archive, pose->T_camera_board);
  archive.number(pose->squared_px);
};

}  // namespace

std::string bytes_of(const std::vector<PixelMatch>& matches) { return bytes_of_parts(kFormat, matches, kMatchesParts); }
std::string bytes_of(const FoundMotion& motion) { return bytes_of_parts(kFormat, motion, kMotionParts); }
std::string bytes_of(const std::optional<CloudPlane>& plane) { return bytes_of_parts(kFormat, plane, kPlaneParts); }

std::string bytes_of(const std::optional<ChessboardCorners>& corners) {
  return bytes_of_parts(kFormat, corners, kChessboardParts);
}

std::string bytes_of(const std::optional<ReferencePose>& pose) {
  return bytes_of_parts(kFormat, pose, kReferencePoseParts);
}

bool read_bytes(const std::string& bytes, std::vector<PixelMatch>* matches) {
  return read_parts(kFormat, bytes, matches, kMatchesParts);
}
bool read_bytes(const std::string& bytes, FoundMotion* motion) {
  return read_parts(kFormat, bytes, motion, kMotionParts);
}
bool read_bytes(const std::string& bytes, std::optional<CloudPlane>* plane) {
  return read_parts(kFormat, bytes, plane, kPlaneParts);
}
bool read_bytes(const std::string& bytes, std::optional<ChessboardCorners>* corners) {
  return read_parts(kFormat, bytes, corners, kChessboardParts);
}
bool read_bytes(const std::string& bytes, std::optional<ReferencePose>* pose) {
  return read_parts(kFormat, bytes, pose, kReferencePoseParts);
}

std::string matches_key(const std::string& source, const std::string& content_a, const std::string& content_b,
                        const Camera& camera) {
  Writer key = key_of("matches of");
  for (const std::string& text : {source, content_a, content_b}) key.text(text);
  key.number(camera.width_px);
  key.number(camera.height_px);
  return sha256_hex(key.bytes());
}

std::string motion_key(const std::string& matches, const Camera& camera, double sigma) {
  Writer key = key_of("motion by");
  key.text(matches);
  write(camera, &key);
  key.number(sigma);
  return sha256_hex(key.bytes());
}

std::string cloud_key(const std::string& content, const RigCamera& camera, int points) {
  Writer key = key_of("plane of a cloud");
  key.text(content);
  write(camera.camera, &key);
  if (camera.depth) write(*camera.depth, &key);
  key.number(points);
  return sha256_hex(key.bytes());
}

std::string chessboard_key(const std::string& content, const Camera& camera, const Board& board) {
  Writer key = key_of("chessboard");
  key.text(content);
  for (const int number : {camera.width_px, camera.height_px, board.inner_corners_x(), board.inner_corners_y()})
    key.number(number);
  return sha256_hex(key.bytes());
}

std::string reference_pose_key(const ChessboardCorners& corners, const Camera& camera, const Board& board) {
  Writer key = key_of("reference pose");
  for (const Eigen::Vector2f& pixel : corners.pixels) key.matrix(pixel);
  write(camera, &key);
  for (const Eigen::Vector3d& corner : board.corners()) key.matrix(corner);
  return sha256_hex(key.bytes());
}

}  // namespace rigproof::rivals

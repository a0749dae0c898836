#include "sight.h"

#include <cstdint>

#include "finding_bytes.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/files.h"

namespace rigproof::detection {
namespace {

// Raised whenever what is found in a picture, or these bytes, change.
constexpr std::uint32_t kFormat = 6;

constexpr auto kPlaneParts = [](auto& archive, auto& plane) {
  if (!archive.present(plane)) return;
  archive.matrix(plane->inverse_depth_plane);
  archive.matrix(plane->covariance_per_m2);
  archive.number(plane->effective_points);
  archive.number(plane->inlier_points);
  archive.number(plane->residual_rms);
};

constexpr auto kFindingParts = [](auto& archive, auto& finding) {
  constexpr std::size_t kValueBytes = 6;
  if (!archive.present(finding)) return;
  archive.text(finding->code);
  archive.size(finding->values, kValueBytes);
  for (auto& value : finding->values) {
    archive.text(value.name);
    archive.number_or_text(value.value);
  }
};

constexpr auto kSightParts = [](auto& archive, auto& sight) {
  constexpr std::size_t kCornerBytes = sizeof(int) + 6 * sizeof(double);
  archive.flag(sight.readable);
  archive.flag(sight.wrong_size);
  kFindingParts(archive, sight.why_not);
  archive.size(sight.corners, kCornerBytes);
  for (auto& corner : sight.corners) {
    archive.number(corner.id);
    archive.matrix(corner.pixel);
    archive.matrix(corner.covariance_px2);
  }
};

constexpr auto kPlaneSightParts = [](auto& archive, auto& planes) {
  kFindingParts(archive, planes.why_not);
  kPlaneParts(archive, planes.ground);
  kPlaneParts(archive, planes.board);
};

// Bytes hold no severity: what was not found is left out.
template <typename Seen, typename Parts>
bool read_seen(const std::string& bytes, Seen* seen, const Parts& parts) {
  if (!read_parts(kFormat, bytes, seen, parts)) return false;
  if (seen->why_not) seen->why_not->severity = Severity::kLeftOut;
  return true;
}

void write(const Board& board, Writer* to) {
  to->text(board.type);
  to->number(board.squares_x);
  to->number(board.squares_y);
  to->number(board.square_m);
  if (board.type == "checkerboard") return;
  to->text(dictionary_of(board).name);
  to->number(board.marker_side_m());
  to->number(static_cast<int>(board.legacy_pattern));
}

Writer begun_key(const char* kind, const std::string& content) {
  Writer key(kFormat);
  key.kind(kind);
  key.text(content);
  return key;
}

}  // namespace

std::string bytes_of(const Sight& sight) { return bytes_of_parts(kFormat, sight, kSightParts); }
std::string bytes_of(const PlaneSight& planes) { return bytes_of_parts(kFormat, planes, kPlaneSightParts); }
bool read_bytes(const std::string& bytes, Sight* sight) { return read_seen(bytes, sight, kSightParts); }
bool read_bytes(const std::string& bytes, PlaneSight* planes) { return read_seen(bytes, planes, kPlaneSightParts); }

std::string corners_key(const std::string& content, const Camera& camera, const Board& board,
                        const std::vector<Board>& others) {
  Writer key = begun_key("corners", content);
  key.number(camera.width_px);
  key.number(camera.height_px);
  write(board, &key);
  for (const Board& other : others) write(other, &key);
  return sha256_hex(key.bytes());
}

std::string planes_key(const std::string& content, const RigCamera& camera, const Board& board, int points,
                       const std::optional<Rigid3>& T_camera_board, const std::optional<Eigen::Vector3d>& up_camera) {
  Writer key = begun_key("planes", content);
  write(camera.camera, &key);
  if (camera.depth) write(*camera.depth, &key);
  write(board, &key);
  key.number(points);
  if (key.present(T_camera_board)) kTransformParts(key, *T_camera_board);
  if (key.present(up_camera)) key.matrix(*up_camera);
  return sha256_hex(key.bytes());
}

}  // namespace rigproof::detection

#include "sight.h"

#include <cstdint>

#include "finding_bytes.h"
#include "rigproof/core/files.h"

namespace rigproof::detection {
namespace {

// Raised whenever what is found in a picture, or these bytes, change.
constexpr std::uint32_t kFormat = 3;

void write(const std::optional<PlaneObservation>& plane, Writer* to) {
  to->number(static_cast<std::uint8_t>(plane.has_value()));
  if (!plane) return;
  to->matrix(plane->inverse_depth_plane);
  to->matrix(plane->covariance_per_m2);
  to->number(plane->effective_points);
  to->number(plane->inlier_points);
  to->number(plane->residual_rms);
}

void read(Reader* from, std::optional<PlaneObservation>* plane) {
  plane->reset();
  if (!from->flag()) return;
  PlaneObservation& value = plane->emplace();
  from->matrix(&value.inverse_depth_plane);
  from->matrix(&value.covariance_per_m2);
  from->number(&value.effective_points);
  from->number(&value.inlier_points);
  from->number(&value.residual_rms);
}

void write(const std::optional<Finding>& finding, Writer* to) {
  to->number(static_cast<std::uint8_t>(finding.has_value()));
  if (!finding) return;
  to->text(finding->code);
  to->number(static_cast<std::uint32_t>(finding->values.size()));
  for (const FindingValue& value : finding->values) {
    const auto* number = std::get_if<double>(&value.value);
    to->text(value.name);
    to->number(static_cast<std::uint8_t>(number != nullptr));
    if (number != nullptr)
      to->number(*number);
    else
      to->text(std::get<std::string>(value.value));
  }
}

void read(Reader* from, std::optional<Finding>* finding) {
  constexpr std::size_t kValueBytes = 6;
  finding->reset();
  if (!from->flag()) return;
  Finding& found = finding->emplace();
  found.severity = Severity::kLeftOut;
  from->text(&found.code);
  found.values.resize(from->count(kValueBytes));
  for (FindingValue& value : found.values) {
    from->text(&value.name);
    if (from->flag())
      from->number(&value.value.emplace<double>());
    else
      from->text(&value.value.emplace<std::string>());
  }
}

bool is_format(Reader* from) {
  std::uint32_t format = 0;
  from->number(&format);
  return format == kFormat;
}

void write(const Board& board, Writer* to) {
  to->text(board.type);
  to->number(board.squares_x);
  to->number(board.squares_y);
  to->number(board.square_m);
}

Writer begun_key(const char* kind, const std::string& content) {
  Writer key;
  key.number(kFormat);
  key.text(kind);
  key.text(content);
  return key;
}

}  // namespace

std::string bytes_of(const Sight& sight) {
  Writer to;
  to.number(kFormat);
  to.number(static_cast<std::uint8_t>(sight.readable));
  to.number(static_cast<std::uint8_t>(sight.wrong_size));
  write(sight.why_not, &to);
  to.number(static_cast<std::uint32_t>(sight.corners.size()));
  for (const CornerObservation& corner : sight.corners) {
    to.number(corner.id);
    to.matrix(corner.pixel);
    to.matrix(corner.covariance_px2);
  }
  return to.bytes();
}

std::string bytes_of(const PlaneSight& planes) {
  Writer to;
  to.number(kFormat);
  write(planes.why_not, &to);
  write(planes.ground, &to);
  write(planes.board, &to);
  return to.bytes();
}

bool read_bytes(const std::string& bytes, Sight* sight) {
  constexpr std::size_t kCornerBytes = sizeof(int) + 6 * sizeof(double);
  Reader from(bytes);
  if (!is_format(&from)) return false;
  Sight read = *sight;
  read.readable = from.flag();
  read.wrong_size = from.flag();
  detection::read(&from, &read.why_not);
  read.corners.resize(from.count(kCornerBytes));
  for (CornerObservation& corner : read.corners) {
    from.number(&corner.id);
    from.matrix(&corner.pixel);
    from.matrix(&corner.covariance_px2);
  }
  if (!from.finished()) return false;
  *sight = std::move(read);
  return true;
}

bool read_bytes(const std::string& bytes, PlaneSight* planes) {
  Reader from(bytes);
  if (!is_format(&from)) return false;
  PlaneSight found;
  read(&from, &found.why_not);
  read(&from, &found.ground);
  read(&from, &found.board);
  if (!from.finished()) return false;
  *planes = std::move(found);
  return true;
}

std::string corners_key(const std::string& content, const Camera& camera, const Board& board) {
  Writer key = begun_key("corners", content);
  key.number(camera.width_px);
  key.number(camera.height_px);
  write(board, &key);
  return sha256_hex(key.bytes());
}

std::string planes_key(const std::string& content, const RigCamera& camera, const Board& board, int points,
                       const std::optional<Rigid3>& T_camera_board, const std::optional<Eigen::Vector3d>& up_camera) {
  Writer key = begun_key("planes", content);
  write(camera.camera, &key);
  if (camera.depth) write(*camera.depth, &key);
  write(board, &key);
  key.number(points);
  key.number(static_cast<std::uint8_t>(T_camera_board.has_value()));
  if (T_camera_board) write(*T_camera_board, &key);
  key.number(static_cast<std::uint8_t>(up_camera.has_value()));
  if (up_camera) key.matrix(*up_camera);
  return sha256_hex(key.bytes());
}

}  // namespace rigproof::detection

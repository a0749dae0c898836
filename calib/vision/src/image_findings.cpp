#include "rigproof/calib/vision/image_findings.h"

#include "finding_bytes.h"
#include "rigproof/core/files.h"

namespace rigproof::rivals {
namespace {

using detection::Reader;
using detection::Writer;

// Raised whenever what is found, or these bytes, change.
constexpr std::uint32_t kFormat = 1;

Writer begun(const char* kind) {
  Writer to;
  to.number(kFormat);
  to.text(kind);
  return to;
}

bool is_format(Reader* from, const char* kind) {
  std::uint32_t format = 0;
  std::string text;
  from->number(&format);
  from->text(&text);
  return format == kFormat && text == kind;
}

}  // namespace

std::string bytes_of(const std::vector<PixelMatch>& matches) {
  Writer to = begun("matches");
  to.number(static_cast<std::uint32_t>(matches.size()));
  for (const PixelMatch& match : matches) {
    to.matrix(match.a);
    to.matrix(match.b);
  }
  return to.bytes();
}

std::string bytes_of(const FoundMotion& motion) {
  Writer to = begun("motion");
  to.number(static_cast<std::uint8_t>(motion.T_a_b.has_value()));
  if (motion.T_a_b) write(*motion.T_a_b, &to);
  to.number(static_cast<std::uint32_t>(motion.agrees.size()));
  for (const bool agrees : motion.agrees) to.number(static_cast<std::uint8_t>(agrees));
  return to.bytes();
}

std::string bytes_of(const std::optional<CloudPlane>& plane) {
  Writer to = begun("cloud plane");
  to.number(static_cast<std::uint8_t>(plane.has_value()));
  if (plane) {
    to.matrix(plane->normal);
    to.number(plane->d);
  }
  return to.bytes();
}

bool read_bytes(const std::string& bytes, std::vector<PixelMatch>* matches) {
  Reader from(bytes);
  if (!is_format(&from, "matches")) return false;
  std::vector<PixelMatch> read(from.count(sizeof(PixelMatch)));
  for (PixelMatch& match : read) {
    from.matrix(&match.a);
    from.matrix(&match.b);
  }
  if (!from.finished()) return false;
  *matches = std::move(read);
  return true;
}

bool read_bytes(const std::string& bytes, FoundMotion* motion) {
  Reader from(bytes);
  if (!is_format(&from, "motion")) return false;
  FoundMotion read;
  if (from.flag()) {
    Rigid3& T = read.T_a_b.emplace();
    from.matrix(&T.rotation.coeffs());
    from.matrix(&T.translation);
  }
  read.agrees.resize(from.count(1));
  for (std::size_t i = 0; i < read.agrees.size(); ++i) read.agrees[i] = from.flag();
  if (!from.finished()) return false;
  *motion = std::move(read);
  return true;
}

bool read_bytes(const std::string& bytes, std::optional<CloudPlane>* plane) {
  Reader from(bytes);
  if (!is_format(&from, "cloud plane")) return false;
  std::optional<CloudPlane> read;
  if (from.flag()) {
    CloudPlane& value = read.emplace();
    from.matrix(&value.normal);
    from.number(&value.d);
  }
  if (!from.finished()) return false;
  *plane = read;
  return true;
}

std::string matches_key(const std::string& source, const std::string& content_a, const std::string& content_b,
                        const Camera& camera) {
  Writer key = begun("matches of");
  for (const std::string& text : {source, content_a, content_b}) key.text(text);
  key.number(camera.width_px);
  key.number(camera.height_px);
  return sha256_hex(key.bytes());
}

std::string motion_key(const std::string& matches, const Camera& camera, double sigma) {
  Writer key = begun("motion by");
  key.text(matches);
  write(camera, &key);
  key.number(sigma);
  return sha256_hex(key.bytes());
}

std::string cloud_key(const std::string& content, const RigCamera& camera, int points, int stop, int index) {
  Writer key = begun("plane of a cloud");
  key.text(content);
  write(camera.camera, &key);
  if (camera.depth) write(*camera.depth, &key);
  for (const int number : {points, stop, index}) key.number(number);
  return sha256_hex(key.bytes());
}

}  // namespace rigproof::rivals

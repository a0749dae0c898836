// PCD (pointclouds.org's format, version 0.7) and plain text clouds.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "rigproof/calib/vision/image_io.h"

namespace rigproof {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Points = std::vector<Eigen::Vector3f>;
using Cloud = std::variant<Points, Unreadable>;

// More points than any depth image has.
constexpr std::size_t kMaxPoints = std::size_t{1} << 26U;

/// Splits at white space, commas and semicolons.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  std::optional<std::string_view> next() {
    const auto is_gap = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; };
    while (at_ < text_.size() && is_gap(text_[at_])) ++at_;
    if (at_ == text_.size()) return std::nullopt;
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_gap(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }
  std::optional<float> next_number() {
    const std::optional<std::string_view> word = next();
    if (!word) return std::nullopt;
    if (*word == "nan" || *word == "NaN" || *word == "-nan") return std::numeric_limits<float>::quiet_NaN();
    float value = 0.0F;
    const auto [end, failure] = std::from_chars(word->data(), word->data() + word->size(), value);
    if (failure != std::errc() || end != word->data() + word->size()) return std::nullopt;
    return value;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  std::optional<std::string_view> next() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t start = at_, end = std::min(text_.find('\n', at_), text_.size());
    at_ = end + 1;
    ++number_;
    return text_.substr(start, end - start);
  }
  std::size_t position() const { return std::min(at_, text_.size()); }
  int number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_ = 0;
};

void add_if_finite(const Eigen::Vector3f& point, Points* points) {
  if (point.allFinite()) points->push_back(point);
}

Unreadable bad_line(int line) { return Unreadable{"line " + std::to_string(line) + ": must begin with three numbers"}; }

// Words `columns[0..2]` of each line are x, y, z.
Cloud read_text(Lines lines, const std::array<std::size_t, 3>& columns, std::size_t words) {
  Points points;
  while (const std::optional<std::string_view> line = lines.next()) {
    Words reader(*line);
    if (line->empty() || line->front() == '#' || !Words(*line).next()) continue;
    Eigen::Vector3f point;
    for (std::size_t word = 0; word < words; ++word) {
      const std::optional<float> value = reader.next_number();
      if (!value) return bad_line(lines.number());
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (columns[axis] == word) point[static_cast<Eigen::Index>(axis)] = *value;
    }
    if (points.size() == kMaxPoints) return Unreadable{"more than 67 million points"};
    add_if_finite(point, &points);
  }
  if (points.empty()) return Unreadable{"cloud without a point"};
  return points;
}

struct PcdField {
  std::string name;
  std::size_t size = 4;
  char type = 'F';
  std::size_t count = 1;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::string data;
  std::size_t body = 0;  ///< where the data begin
  int lines = 0;

  std::size_t point_size() const {
    std::size_t size = 0;
    for (const PcdField& field : fields) size += field.size * field.count;
    return size;
  }
};

template <typename Set>
bool read_list(Words words, std::vector<PcdField>* fields, Set set) {
  std::size_t i = 0;
  while (const std::optional<std::string_view> word = words.next()) {
    if (i >= fields->size() || !set(&(*fields)[i], *word)) return false;
    ++i;
  }
  return i == fields->size();
}

std::optional<std::size_t> to_size(std::string_view word, std::size_t max) {
  std::size_t value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure != std::errc() || end != word.data() + word.size() || value > max) return std::nullopt;
  return value;
}

bool set_size(std::size_t* target, std::string_view word, std::size_t max) {
  const std::optional<std::size_t> value = to_size(word, max);
  if (value) *target = *value;
  return value.has_value();
}

// One line of the header; false if it makes no sense.
bool read_header_line(std::string_view key, Words words, PcdHeader* header) {
  constexpr std::size_t kMaxFields = 64;
  if (key == "FIELDS") {
    while (const std::optional<std::string_view> word = words.next())
      header->fields.push_back({std::string(*word), 4, 'F', 1});
    return !header->fields.empty() && header->fields.size() <= kMaxFields;
  }
  if (key == "SIZE")
    return read_list(words, &header->fields, [](PcdField* f, auto word) { return set_size(&f->size, word, 8); });
  if (key == "COUNT")
    return read_list(words, &header->fields, [](PcdField* f, auto word) { return set_size(&f->count, word, 1024); });
  if (key == "TYPE")
    return read_list(words, &header->fields, [](PcdField* f, std::string_view word) {
      f->type = word.front();
      return word.size() == 1;
    });
  if (key == "POINTS") {
    const std::optional<std::string_view> word = words.next();
    return word && set_size(&header->points, *word, kMaxPoints);
  }
  if (key == "DATA") {
    header->data = std::string(words.next().value_or(""));
    return !header->data.empty();
  }
  return true;  // VERSION, WIDTH, HEIGHT, VIEWPOINT
}

std::optional<PcdHeader> read_pcd_header(std::string_view text) {
  PcdHeader header;
  Lines lines(text);
  while (header.data.empty()) {
    const std::optional<std::string_view> line = lines.next();
    if (!line || lines.number() > 64) return std::nullopt;
    Words words(*line);
    const std::optional<std::string_view> key = words.next();
    if (!key || key->front() == '#') continue;
    if (!read_header_line(*key, words, &header)) return std::nullopt;
  }
  header.body = lines.position();
  header.lines = lines.number();
  return header;
}

/// Where x, y and z lie.
struct Layout {
  std::array<std::size_t, 3> columns;  ///< in words of a text line
  std::array<std::size_t, 3> offsets;  ///< in bytes of a point
};

std::optional<Layout> layout_of(const PcdHeader& header) {
  Layout layout{};
  std::array<int, 3> found{};
  std::size_t column = 0, offset = 0;
  for (const PcdField& field : header.fields) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (field.name != std::string(1, "xyz"[axis])) continue;
      if (field.type != 'F' || field.size != 4 || field.count != 1) return std::nullopt;
      layout.columns[axis] = column;
      layout.offsets[axis] = offset;
      ++found[axis];
    }
    column += field.count;
    offset += field.size * field.count;
  }
  if (found != std::array<int, 3>{1, 1, 1}) return std::nullopt;
  return layout;
}

float float_at(const std::uint8_t* bytes) {
  float value = 0.0F;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

Cloud read_binary(const std::uint8_t* data, const PcdHeader& header, const Layout& layout) {
  Points points;
  points.reserve(header.points);
  const std::size_t step = header.point_size();
  for (std::size_t i = 0; i < header.points; ++i, data += step)
    add_if_finite(
        {float_at(data + layout.offsets[0]), float_at(data + layout.offsets[1]), float_at(data + layout.offsets[2])},
        &points);
  return points;
}

// LZF (Lehmann's liblzf format): runs of literals and references back. Empty if the data are damaged.
Bytes decompress_lzf(const std::uint8_t* in, std::size_t size, std::size_t expected) {
  Bytes out;
  out.reserve(expected);
  const std::uint8_t* const end = in + size;
  while (in < end) {
    const std::size_t control = *in++;
    if (control < 32) {
      const std::size_t length = control + 1;
      if (static_cast<std::size_t>(end - in) < length || out.size() + length > expected) return {};
      out.insert(out.end(), in, in + length);
      in += length;
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == 7) {
      if (in == end) return {};
      length += *in++;
    }
    if (in == end) return {};
    const std::size_t distance = ((control & 31U) << 8U) + *in++ + 1;
    length += 2;
    if (distance > out.size() || out.size() + length > expected) return {};
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - distance]);
  }
  return out.size() == expected ? out : Bytes();
}

std::uint32_t little_endian(const std::uint8_t* p) {
  return p[0] | (std::uint32_t{p[1]} << 8U) | (std::uint32_t{p[2]} << 16U) | (std::uint32_t{p[3]} << 24U);
}

// Compressed clouds hold all x, then all y, ...
Cloud read_compressed(const Bytes& bytes, const PcdHeader& header, const Layout& layout) {
  if (bytes.size() - header.body < 8) return Unreadable{"truncated cloud"};
  const std::uint8_t* start = bytes.data() + header.body;
  const std::size_t compressed = little_endian(start), size = little_endian(start + 4);
  if (compressed > bytes.size() - header.body - 8) return Unreadable{"truncated cloud"};
  if (size != header.points * header.point_size() || size / 300 > compressed) return Unreadable{"damaged PCD"};
  const Bytes data = decompress_lzf(start + 8, compressed, size);
  if (data.empty()) return Unreadable{"damaged PCD"};
  Points points;
  points.reserve(header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const auto value = [&](std::size_t axis) {
      return float_at(data.data() + layout.offsets[axis] * header.points + 4 * i);
    };
    add_if_finite({value(0), value(1), value(2)}, &points);
  }
  return points;
}

Cloud read_pcd(const Bytes& bytes, std::string_view text) {
  const std::optional<PcdHeader> header = read_pcd_header(text);
  if (!header) return Unreadable{"damaged PCD (header)"};
  const std::optional<Layout> layout = layout_of(*header);
  if (!layout) return Unreadable{"PCD without x y z as 4-byte floats"};
  if (header->points == 0) return Unreadable{"cloud without a point"};
  if (header->data == "ascii") {
    std::size_t words = *std::max_element(layout->columns.begin(), layout->columns.end()) + 1;
    return read_text(Lines(text.substr(header->body)), layout->columns, words);
  }
  if (header->data == "binary_compressed") return read_compressed(bytes, *header, *layout);
  if (header->data != "binary") return Unreadable{"PCD data of an unknown kind"};
  if ((bytes.size() - header->body) / header->point_size() < header->points) return Unreadable{"truncated cloud"};
  return read_binary(bytes.data() + header->body, *header, *layout);
}

}  // namespace

Cloud decode_point_cloud(const Bytes& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool is_pcd = text.substr(0, 6) == "# .PCD" || text.substr(0, 7) == "VERSION";
  if (is_pcd) return read_pcd(bytes, text);
  return read_text(Lines(text), {0, 1, 2}, 3);
}

}  // namespace rigproof

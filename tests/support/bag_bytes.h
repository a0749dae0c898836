// Bags as other programs write them, made byte by byte: CDR in both byte orders, MCAP and SQLite with every
// compression.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rigproof {

/// Plain CDR with its encapsulation.
class CdrBytes {
 public:
  explicit CdrBytes(bool big_endian = false) : big_endian_(big_endian), bytes_{0, char(big_endian ? 0 : 1), 0, 0} {}

  template <typename Number>
  CdrBytes& number(Number value) {
    while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_ += '\0';
    char raw[sizeof(Number)];
    std::memcpy(raw, &value, sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i) bytes_ += raw[big_endian_ ? sizeof(Number) - 1 - i : i];
    return *this;
  }
  CdrBytes& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_ += value;
    bytes_ += '\0';
    return *this;
  }
  CdrBytes& bytes(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  template <typename Numbers>
  CdrBytes& numbers(const Numbers& values) {
    for (const double value : values) number(value);
    return *this;
  }
  CdrBytes& header(double stamp_s, const std::string& frame_id);
  const std::string& str() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

struct ImageFields {
  double stamp_s = 0.0;
  std::string frame_id = "camera_optical";
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool big_endian_pixels = false;
  std::string data;
};
std::string image_message(const ImageFields& image, bool big_endian = false);
std::string compressed_message(double stamp_s, const std::string& frame_id, const std::string& format,
                               const std::string& data, bool big_endian = false);

struct InfoFields {
  std::string frame_id = "camera_optical";
  std::uint32_t width = 0, height = 0;
  std::string model = "plumb_bob";
  std::vector<double> d = {0, 0, 0, 0, 0};
  std::vector<double> k = {0, 0, 0, 0, 0, 0, 0, 0, 1};
  std::vector<double> r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::vector<double> p = std::vector<double>(12, 0.0);
  std::uint32_t binning_x = 0, binning_y = 0, x_offset = 0, y_offset = 0, roi_height = 0, roi_width = 0;
};
std::string info_message(const InfoFields& info, double stamp_s = 0.0, bool big_endian = false);

struct PoseFields {
  double x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 1;
};
std::string odometry_message(double stamp_s, const PoseFields& pose, const std::string& child = "base_link",
                             bool big_endian = false);
struct TransformFields {
  std::string parent, child;
  PoseFields pose;
};
std::string tf_message(double stamp_s, const std::vector<TransformFields>& transforms, bool big_endian = false);

/// One message of a bag.
struct Recorded {
  std::string topic, type;
  double log_s = 0.0;
  std::string data;
};

struct McapLayout {
  std::string compression;  ///< of chunks: "", "lz4" or "zstd"
  bool chunks = true;
  bool checksums = true;
  bool finished = true;            ///< false: it ends after the last chunk or message
  std::size_t chunk_bytes = 4096;  ///< a chunk is closed when it is larger
  std::string profile = "ros2";
  std::string encoding = "cdr";
};
std::string mcap_bytes(const std::vector<Recorded>& messages, const McapLayout& layout = {});
/// A record of MCAP.
std::string mcap_record(std::uint8_t opcode, const std::string& content);
/// A chunk whose numbers may lie.
std::string mcap_chunk(const std::string& records, const std::string& compression, std::uint64_t unpacked_size,
                       std::uint32_t crc);

/// @param schema 1: without QoS; 3: with it; 4: with the tables of later versions
void write_sqlite_bag(const std::filesystem::path& file, const std::vector<Recorded>& messages, int schema = 4);

std::string zstd_packed(const std::string& bytes);
std::string metadata_yaml(const std::vector<std::string>& files, const std::string& storage = "mcap");

}  // namespace rigproof

#include "bag_bytes.h"

#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <map>
#include <stdexcept>

namespace rigproof {
namespace {

// Of seconds since 1970 a product would lose the last digits.
std::int64_t nanoseconds(double seconds) {
  const double whole = std::floor(seconds);
  return static_cast<std::int64_t>(whole) * 1000000000 + std::llround((seconds - whole) * 1e9);
}

template <typename Number>
std::string raw(Number value) {
  std::string bytes(sizeof(Number), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Number));
  return bytes;
}

std::string prefixed(const std::string& text) { return raw(static_cast<std::uint32_t>(text.size())) + text; }

std::uint32_t crc_of(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

std::string lz4_packed(const std::string& bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

void pose_into(CdrBytes& cdr, const PoseFields& p) {
  cdr.numbers(std::vector<double>{p.x, p.y, p.z, p.qx, p.qy, p.qz, p.qw});
}

class McapBytes {
 public:
  explicit McapBytes(const McapLayout& layout) : layout_(layout) {
    bytes_ = kMagic + mcap_record(1, prefixed(layout.profile) + prefixed("test"));
  }

  void add(const Recorded& message) {
    const std::uint16_t id = channel(message);
    const auto time = static_cast<std::uint64_t>(nanoseconds(message.log_s));
    append(mcap_record(5, raw(id) + raw(std::uint32_t{0}) + raw(time) + raw(time) + message.data));
    if (pending_.size() > layout_.chunk_bytes) close_chunk();
  }

  std::string finish() {
    close_chunk();
    if (!layout_.finished) return bytes_;
    bytes_ += mcap_record(0x0F, raw(layout_.checksums ? crc_of(bytes_) : 0U));
    return bytes_ + mcap_record(2, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(std::uint32_t{0})) + kMagic;
  }

 private:
  std::uint16_t channel(const Recorded& message) {
    const auto [place, is_new] =
        channels_.emplace(message.topic + message.type, static_cast<std::uint16_t>(channels_.size() + 1));
    if (is_new) {
      append(mcap_record(3, raw(place->second) + prefixed(message.type) + prefixed("ros2msg") + prefixed("")));
      append(mcap_record(4, raw(place->second) + raw(place->second) + prefixed(message.topic) +
                                prefixed(layout_.encoding) + raw(std::uint32_t{0})));
    }
    return place->second;
  }

  void append(const std::string& record) { (layout_.chunks ? pending_ : bytes_) += record; }

  void close_chunk() {
    if (!layout_.chunks || pending_.empty()) return;
    const std::string packed = layout_.compression == "zstd"  ? zstd_packed(pending_)
                               : layout_.compression == "lz4" ? lz4_packed(pending_)
                                                              : pending_;
    bytes_ += mcap_chunk(packed, layout_.compression, pending_.size(), layout_.checksums ? crc_of(pending_) : 0U);
    bytes_ += mcap_record(7, raw(std::uint16_t{1}) + prefixed(""));  // an index that nobody needs
    pending_.clear();
  }

  static inline const std::string kMagic = std::string("\x89MCAP0\r\n", 8);
  McapLayout layout_;
  std::string bytes_, pending_;
  std::map<std::string, std::uint16_t> channels_;
};

class Database {
 public:
  explicit Database(const std::filesystem::path& file) {
    if (sqlite3_open(file.c_str(), &database_) != SQLITE_OK) throw std::runtime_error(sqlite3_errmsg(database_));
  }
  ~Database() { sqlite3_close(database_); }
  void run(const std::string& sql) {
    if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(database_));
  }
  void insert(std::int64_t topic, std::int64_t time, const std::string& data) {
    sqlite3_stmt* row = nullptr;
    sqlite3_prepare_v2(database_, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", -1, &row,
                       nullptr);
    sqlite3_bind_int64(row, 1, topic);
    sqlite3_bind_int64(row, 2, time);
    sqlite3_bind_blob(row, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    sqlite3_step(row);
    sqlite3_finalize(row);
  }

 private:
  sqlite3* database_ = nullptr;
};

}  // namespace

CdrBytes& CdrBytes::header(double stamp_s, const std::string& frame_id) {
  const std::int64_t ns = nanoseconds(stamp_s);
  number(static_cast<std::int32_t>(ns / 1000000000));
  number(static_cast<std::uint32_t>(ns % 1000000000));
  return text(frame_id);
}

std::string image_message(const ImageFields& image, bool big_endian) {
  CdrBytes cdr(big_endian);
  cdr.header(image.stamp_s, image.frame_id).number(image.height).number(image.width).text(image.encoding);
  return cdr.number(std::uint8_t{image.big_endian_pixels}).number(image.step).bytes(image.data).str();
}

std::string compressed_message(double stamp_s, const std::string& frame_id, const std::string& format,
                               const std::string& data, bool big_endian) {
  return CdrBytes(big_endian).header(stamp_s, frame_id).text(format).bytes(data).str();
}

std::string info_message(const InfoFields& info, double stamp_s, bool big_endian) {
  CdrBytes cdr(big_endian);
  cdr.header(stamp_s, info.frame_id).number(info.height).number(info.width).text(info.model);
  cdr.number(static_cast<std::uint32_t>(info.d.size())).numbers(info.d).numbers(info.k).numbers(info.r).numbers(info.p);
  for (const std::uint32_t value :
       {info.binning_x, info.binning_y, info.x_offset, info.y_offset, info.roi_height, info.roi_width})
    cdr.number(value);
  return cdr.number(std::uint8_t{0}).str();
}

std::string odometry_message(double stamp_s, const PoseFields& pose, const std::string& child, bool big_endian) {
  CdrBytes cdr(big_endian);
  cdr.header(stamp_s, "odom").text(child);
  pose_into(cdr, pose);
  return cdr.numbers(std::vector<double>(36 + 6 + 36, 0.0)).str();
}

std::string tf_message(double stamp_s, const std::vector<TransformFields>& transforms, bool big_endian) {
  CdrBytes cdr(big_endian);
  cdr.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformFields& transform : transforms) {
    cdr.header(stamp_s, transform.parent).text(transform.child);
    pose_into(cdr, transform.pose);
  }
  return cdr.str();
}

std::string mcap_record(std::uint8_t opcode, const std::string& content) {
  return std::string(1, static_cast<char>(opcode)) + raw(static_cast<std::uint64_t>(content.size())) + content;
}

std::string mcap_chunk(const std::string& records, const std::string& compression, std::uint64_t unpacked_size,
                       std::uint32_t crc) {
  return mcap_record(6, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(unpacked_size) + raw(crc) +
                            prefixed(compression) + raw(static_cast<std::uint64_t>(records.size())) + records);
}

std::string mcap_bytes(const std::vector<Recorded>& messages, const McapLayout& layout) {
  McapBytes mcap(layout);
  for (const Recorded& message : messages) mcap.add(message);
  return mcap.finish();
}

void write_sqlite_bag(const std::filesystem::path& file, const std::vector<Recorded>& messages, int schema) {
  Database database(file);
  if (schema >= 4)
    database.run(
        "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
        "INSERT INTO schema VALUES (4, 'jazzy');");
  database.run(std::string("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                           "serialization_format TEXT NOT NULL") +
               (schema >= 3 ? ", offered_qos_profiles TEXT NOT NULL DEFAULT ''" : "") + ");" +
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
               "data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  std::map<std::string, std::int64_t> ids;
  for (const Recorded& message : messages) {
    const auto [place, is_new] = ids.emplace(message.topic, static_cast<std::int64_t>(ids.size() + 1));
    if (is_new)
      database.run("INSERT INTO topics(id, name, type, serialization_format) VALUES (" + std::to_string(place->second) +
                   ", '" + message.topic + "', '" + message.type + "', 'cdr')");
    database.insert(place->second, nanoseconds(message.log_s), message.data);
  }
}

std::string zstd_packed(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

std::string metadata_yaml(const std::vector<std::string>& files, const std::string& storage) {
  std::string text =
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: " + storage + "\n  relative_file_paths:\n";
  for (const std::string& file : files) text += "    - " + file + "\n";
  return text;
}

}  // namespace rigproof

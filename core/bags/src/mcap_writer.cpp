#include <fcntl.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <utility>
#include <vector>

#include "rigproof/bags/bag_writer.h"
#include "rigproof/bags/messages.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/version.h"
#include "unpack.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = 4U << 20U;  // a chunk is closed when it is larger
constexpr int kZstdLevel = 1;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kDataEnd = 0x0F
};

// What subscribers of /tf_static ask for: the last message is kept for those who come late (rosbag2, profiles of QoS).
constexpr const char* kLatched =
    "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 9223372036\n    nsec: "
    "854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n "
    "   sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false\n";

/// Little-endian numbers and length-prefixed texts, as MCAP has them.
class Bytes {
 public:
  template <typename Number>
  Bytes& number(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);  // x86 and ARM: as in the file
    return *this;
  }
  Bytes& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    return raw(value);
  }
  Bytes& raw(std::string_view value) {
    bytes_.append(value);
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Opcode opcode, std::string_view content) {
  return Bytes().number(static_cast<std::uint8_t>(opcode)).number(std::uint64_t{content.size()}).raw(content).str();
}

std::string packed(BagPacking packing, const std::string& bytes) {
  std::string out;
  if (packing == BagPacking::kZstd) {
    out.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t written = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
    if (ZSTD_isError(written) != 0U) throw Error(std::string("zstd: ") + ZSTD_getErrorName(written));
    out.resize(written);
  } else if (packing == BagPacking::kLz4) {
    out.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    const std::size_t written = LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr);
    if (LZ4F_isError(written) != 0U) throw Error(std::string("lz4: ") + LZ4F_getErrorName(written));
    out.resize(written);
  }
  return out;
}

const char* packing_name(BagPacking packing) {
  return packing == BagPacking::kZstd ? "zstd" : packing == BagPacking::kLz4 ? "lz4" : "";
}

struct Topic {
  std::uint16_t id = 0;
  std::uint32_t messages = 0;
};

struct Times {
  std::uint64_t first = UINT64_MAX, last = 0;
  void take(std::uint64_t time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
  std::uint64_t begin() const { return first == UINT64_MAX ? 0 : first; }
};

}  // namespace

class BagWriter::File {
 public:
  File(const fs::path& file, BagPacking packing) : file_(file), making_(file.string() + ".partial"), packing_(packing) {
    std::error_code error;
    if (fs::exists(fs::symlink_status(file_, error)))
      throw Error(file_.string() + ": there is something already; name a new file");
    if (file_.has_parent_path()) create_folder(file_.parent_path());
    descriptor_ = ::open(making_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw_system_error(file_, "write", errno);
  }
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!done_) ::unlink(making_.c_str());
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  // Not in the constructor: what fails there leaves no object that would take the file away again.
  void begin() {
    put(kMagic);
    put(record(kHeader, Bytes().text("ros2").text(std::string("rigproof ") + version()).str()));
  }

  void write(const std::string& name, const std::string& type, std::int64_t log_time_ns, std::string_view message) {
    Topic& topic = described(name, type);
    const auto time = static_cast<std::uint64_t>(log_time_ns);
    index_[topic.id].number(time).number(std::uint64_t{chunk_.size()});
    Bytes head;
    head.number(topic.id).number(topic.messages++).number(time).number(time);
    chunk_ += record(kMessage, head.raw(message).str());
    chunk_times_.take(time);
    times_.take(time);
    if (chunk_.size() > kChunkBytes) close_chunk();
  }

  void finish() {
    close_chunk();
    put(record(kDataEnd, Bytes().number(crc_).str()));
    const std::uint64_t summary = written_;
    crc_ = 0;
    for (const std::string* part : {&schemas_, &channels_, &chunk_index_}) put(*part);
    put(statistics());
    Bytes footer;  // its CRC is over the summary with all of the footer before it
    footer.number(summary).number(std::uint64_t{0});
    put(record(kFooter, footer.str() + std::string(sizeof crc_, '\0')).substr(0, 9 + footer.str().size()));
    put(Bytes().number(crc_).str());
    put(kMagic);
    close();
  }

 private:
  // Known to the chunk in which it is first needed, and to the summary.
  Topic& described(const std::string& name, const std::string& type) {
    const auto [place, is_new] = topics_.emplace(name, Topic{static_cast<std::uint16_t>(topics_.size() + 1), 0});
    if (!is_new) return place->second;
    const auto [schema, new_schema] = schema_ids_.emplace(type, static_cast<std::uint16_t>(schema_ids_.size() + 1));
    if (new_schema) {
      Bytes content;
      content.number(schema->second).text(type).text("ros2msg").text(message_definition(type));
      schemas_ += record(kSchema, content.str());
      chunk_ += record(kSchema, content.str());
    }
    Bytes qos, content;
    qos.text("offered_qos_profiles").text(name == "/tf_static" ? kLatched : "");
    content.number(place->second.id).number(schema->second).text(name).text("cdr").text(qos.str());
    channels_ += record(kChannel, content.str());
    chunk_ += record(kChannel, content.str());
    return place->second;
  }

  void close_chunk() {
    if (chunk_.empty()) return;
    const std::uint64_t begin = written_;
    const std::string zipped = packed(packing_, chunk_);
    const std::string& records = packing_ == BagPacking::kNone ? chunk_ : zipped;
    Bytes head;
    head.number(chunk_times_.begin()).number(chunk_times_.last).number(std::uint64_t{chunk_.size()});
    head.number(crc32_of(chunk_)).text(packing_name(packing_)).number(std::uint64_t{records.size()});
    put(record(kChunk, head.raw(records).str()));
    const std::uint64_t end = written_;
    Bytes offsets;
    for (const auto& [id, entries] : index_) {
      offsets.number(id).number(written_);
      put(record(kMessageIndex, Bytes().number(id).text(entries.str()).str()));
    }
    Bytes index;
    index.number(chunk_times_.begin()).number(chunk_times_.last).number(begin).number(end - begin);
    index.text(offsets.str()).number(written_ - end).text(packing_name(packing_));
    index.number(std::uint64_t{records.size()}).number(std::uint64_t{chunk_.size()});
    chunk_index_ += record(kChunkIndex, index.str());
    ++chunks_;
    chunk_.clear();
    index_.clear();
    chunk_times_ = {};
  }

  std::string statistics() const {
    std::uint64_t messages = 0;
    Bytes counts, content;
    for (const auto& [name, topic] : topics_) {
      messages += topic.messages;
      counts.number(topic.id).number(std::uint64_t{topic.messages});
    }
    content.number(messages).number(static_cast<std::uint16_t>(schema_ids_.size()));
    content.number(static_cast<std::uint32_t>(topics_.size())).number(std::uint64_t{0}).number(chunks_);
    content.number(times_.begin()).number(times_.last).text(counts.str());
    return record(kStatistics, content.str());
  }

  void put(std::string_view bytes) {
    crc_ = crc32_of(bytes, crc_);
    written_ += bytes.size();
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw_system_error(file_, "write", errno);
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  void close() {
    if (::fsync(descriptor_) != 0) throw_system_error(file_, "write", errno);
    if (::close(std::exchange(descriptor_, -1)) != 0) throw_system_error(file_, "write", errno);
    std::error_code error;
    fs::rename(making_, file_, error);
    if (error) throw_system_error(file_, "write", error.value());
    done_ = true;
  }

  fs::path file_, making_;
  BagPacking packing_;
  int descriptor_ = -1;
  bool done_ = false;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;  // of the data, then of the summary
  std::uint32_t chunks_ = 0;
  std::map<std::string, Topic> topics_;
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schemas_, channels_, chunk_index_;  // records of the summary
  std::string chunk_;
  std::map<std::uint16_t, Bytes> index_;  // of the chunk, by topic
  Times chunk_times_, times_;
};

BagWriter::BagWriter(const fs::path& file, BagPacking packing) : file_(std::make_unique<File>(file, packing)) {
  file_->begin();
}
BagWriter::~BagWriter() = default;

void BagWriter::write(const std::string& topic, const std::string& type, std::int64_t log_time_ns,
                      std::string_view message) {
  file_->write(topic, type, log_time_ns, message);
}

void BagWriter::finish() { file_->finish(); }

}  // namespace rigproof

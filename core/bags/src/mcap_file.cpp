// MCAP (https://mcap.dev/spec): records of opcode, length and content between two magics. Debian 12 has no library.
#include <map>
#include <optional>

#include "bag_file.h"
#include "bounded_bytes.h"
#include "file_window.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "unpack.h"

namespace rigproof {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kRecordHead = 9;  // opcode and length
constexpr std::uint64_t kNoChunk = UINT64_MAX;

enum Opcode : std::uint8_t { kHeader = 1, kFooter, kSchema, kChannel, kMessage, kChunk, kDataEnd = 0x0F };

struct Record {
  std::uint8_t opcode = 0;
  std::uint64_t content = 0;  // byte of its content in the file
  std::uint64_t length = 0;
};

struct Chunk {
  std::uint64_t unpacked_size = 0;
  std::uint32_t crc = 0;
  std::string compression;
  std::string_view records;
};

class McapFile : public BagFile {
 public:
  explicit McapFile(const std::filesystem::path& file) : file_(file), window_(file) { look_for_end(); }

  std::uint64_t size_bytes() const override { return window_.size(); }

  void read(std::uint32_t index, const BagSink& sink) override {
    index_ = index;
    while (!ended_) {
      const std::optional<Record> record = next_record(next_, sink);
      if (!record) return;
      ended_ = record->opcode == kDataEnd;
      if (ended_) return check_data_end(*record, crc_);
      if (record->opcode == kFooter) throw damaged(next_, "a footer before the end of the data");
      crc_ = crc32_of(window_.at(next_, kRecordHead), crc_);
      crc_ = read_record(*record, next_, sink, crc_);
      next_ = record->content + record->length;
      sink.progress(next_);
    }
  }

  bool goes_on() override {
    if (!window_.has_grown_or_stayed()) return false;
    look_for_end();
    return true;
  }

  void read_at(const std::vector<BagPlace>& places, const BagSink& sink) override {
    for (std::size_t begin = 0; begin < places.size();) {
      std::size_t end = begin + 1;
      while (end < places.size() && places[end].chunk == places[begin].chunk) ++end;
      const std::uint64_t at = places[begin].chunk;
      const Record record = head_at(at);
      const std::string_view content = window_.at(record.content, static_cast<std::size_t>(record.length));
      if (record.opcode == kMessage) {
        take_message(content, places[begin], sink);
      } else {
        const std::string_view records = unpack(chunk_of(content, at), at);
        for (std::size_t i = begin; i < end; ++i) read_message_at(records, places[i], sink);
      }
      begin = end;
      sink.progress(at);
    }
  }

 private:
  void look_for_end() {
    const std::uint64_t size = window_.size();
    finished_ = size >= 2 * kMagic.size() && window_.at(size - kMagic.size(), kMagic.size()) == kMagic;
  }

  Error damaged(std::uint64_t at, const std::string& what) const {
    return Error(file_.string() + ": byte " + std::to_string(at) + ": " + what +
                 "; the file is damaged, `mcap recover` (https://mcap.dev/guides/cli) saves what can be read");
  }
  Error too_large(std::uint64_t at, const char* what, std::uint64_t size) const {
    return Error(file_.string() + ": byte " + std::to_string(at) + ": a " + what + " of " + std::to_string(size) +
                 " bytes; at most " + megabytes(static_cast<double>(kMaxPiece)) +
                 " are read, and damaged files may claim any size. `mcap recover --chunk-size 4194304` writes "
                 "smaller ones");
  }

  Record head_at(std::uint64_t at) {
    BoundedBytes head(window_.at(at, kRecordHead));
    Record record;
    record.opcode = head.number<std::uint8_t>();
    record.length = head.number<std::uint64_t>();
    record.content = at + kRecordHead;
    return record;
  }

  // The record at a byte; nothing at the end of a file that was never finished, which is noted.
  std::optional<Record> next_record(std::uint64_t at, const BagSink& sink) {
    const std::uint64_t left = window_.size() - at;
    const Record record = left >= kRecordHead ? head_at(at) : Record();
    if (left >= kRecordHead && record.opcode != 0 && record.length <= left - kRecordHead) return record;
    const std::string missing =
        "a record of " + std::to_string(record.length) + " bytes, of which " + std::to_string(left) + " are there";
    if (finished_) throw damaged(at, left < kRecordHead ? "the data ends without its end mark" : missing);
    sink.note(file_.filename().string() + " was never finished (no footer), or is damaged; read as far as it goes, " +
              std::to_string(at) + " of " + std::to_string(window_.size()) + " bytes" +
              (left >= kRecordHead && record.opcode != 0 ? ", where " + missing : ""));
    return std::nullopt;
  }

  // Returns the CRC of what was read so far, this record with it.
  std::uint32_t read_record(const Record& record, std::uint64_t at, const BagSink& sink, std::uint32_t crc) {
    const bool is_data = record.opcode <= kChunk;
    if (is_data && record.length > kMaxPiece) throw too_large(at, "record", record.length);
    if (!is_data) return skip(record, crc);
    const std::string_view content = window_.at(record.content, static_cast<std::size_t>(record.length));
    crc = crc32_of(content, crc);
    if (record.opcode == kChunk) return read_chunk(chunk_of(content, at), at, sink), crc;
    sink.unpacked(record.length);
    if (record.opcode == kMessage)
      take_message(content, {index_, at, kNoChunk}, sink);
    else
      take_description(record.opcode, content, at, sink);
    return crc;
  }

  // Attachments may be of any size.
  std::uint32_t skip(const Record& record, std::uint32_t crc) {
    constexpr std::uint64_t kStep = 1U << 20U;
    for (std::uint64_t done = 0; done < record.length; done += kStep) {
      const auto size = static_cast<std::size_t>(std::min(kStep, record.length - done));
      crc = crc32_of(window_.at(record.content + done, size), crc);
    }
    return crc;
  }

  void check_data_end(const Record& record, std::uint32_t crc) {
    if (record.length < sizeof(std::uint32_t)) return;
    const auto stated = BoundedBytes(window_.at(record.content, sizeof(std::uint32_t))).number<std::uint32_t>();
    if (stated != 0 && stated != crc) throw damaged(record.content, "the checksum (CRC-32) of all data is wrong");
  }

  Chunk chunk_of(std::string_view content, std::uint64_t at) const {
    BoundedBytes bytes(content);
    bytes.take(2 * sizeof(std::uint64_t));  // first and last time
    Chunk chunk;
    chunk.unpacked_size = bytes.number<std::uint64_t>();
    chunk.crc = bytes.number<std::uint32_t>();
    chunk.compression = bytes.text();
    chunk.records = bytes.take(bytes.number<std::uint64_t>());
    if (!bytes.good()) throw damaged(at, "a chunk that ends early");
    if (chunk.unpacked_size > kMaxPiece) throw too_large(at, "chunk", chunk.unpacked_size);
    return chunk;
  }

  std::string_view unpack(const Chunk& chunk, std::uint64_t at) {
    const auto size = static_cast<std::size_t>(chunk.unpacked_size);
    std::string_view records = chunk.records;
    std::string wrong;
    if (!chunk.compression.empty()) {
      char* to = unpacked_.reserve(size);
      if (chunk.compression == "zstd")
        wrong = unpacker_.unpack_zstd(chunk.records, to, size);
      else if (chunk.compression == "lz4")
        wrong = unpacker_.unpack_lz4(chunk.records, to, size);
      else
        wrong = "compression \"" + for_message(chunk.compression) + "\" is not known; zstd, lz4 and none are";
      records = {to, size};
    } else if (records.size() != size) {
      wrong = "a chunk of " + std::to_string(records.size()) + " bytes that claims " + std::to_string(size);
    }
    if (wrong.empty() && chunk.crc != 0 && crc32_of(records) != chunk.crc)
      wrong = "the checksum (CRC-32) of the chunk is wrong";
    if (!wrong.empty()) throw damaged(at, wrong);
    return records;
  }

  void read_chunk(const Chunk& chunk, std::uint64_t at, const BagSink& sink) {
    const std::string_view records = unpack(chunk, at);
    sink.unpacked(records.size());
    BoundedBytes bytes(records);
    while (bytes.left() > 0) {
      const std::size_t offset = bytes.position();
      const auto opcode = bytes.number<std::uint8_t>();
      const std::string_view content = bytes.take(bytes.number<std::uint64_t>());
      if (!bytes.good()) throw damaged(at, "a record that reaches beyond its chunk");
      if (opcode == kMessage)
        take_message(content, {index_, at, offset}, sink);
      else
        take_description(opcode, content, at, sink);
    }
  }

  void read_message_at(std::string_view records, const BagPlace& place, const BagSink& sink) {
    BoundedBytes bytes(records);
    bytes.take(place.offset + 1);
    take_message(bytes.take(bytes.number<std::uint64_t>()), place, sink);
  }

  void take_message(std::string_view content, const BagPlace& place, const BagSink& sink) {
    BoundedBytes bytes(content);
    const auto channel = channels_.find(bytes.number<std::uint16_t>());
    bytes.number<std::uint32_t>();  // sequence
    const auto log_time = bytes.number<std::uint64_t>();
    bytes.number<std::uint64_t>();  // publish time
    if (!bytes.good()) throw damaged(place.chunk, "a message that ends early");
    if (channel == channels_.end()) throw damaged(place.chunk, "a message of a channel that was never described");
    if (sink.wants(channel->second))
      sink.take({channel->second, static_cast<std::int64_t>(log_time), place, bytes.rest()});
  }

  void take_description(std::uint8_t opcode, std::string_view content, std::uint64_t at, const BagSink& sink) {
    BoundedBytes bytes(content);
    if (opcode == kHeader && bytes.text() == "ros1")
      throw Error(file_.string() + ": holds messages of ROS 1; convert it: rosbags-convert --src " +
                  file_.filename().string() + " --dst " + file_.stem().string());
    if (opcode == kSchema) {
      const auto id = bytes.number<std::uint16_t>();
      schemas_[id] = std::string(bytes.text());
    }
    if (opcode == kChannel) {
      const auto id = bytes.number<std::uint16_t>();
      const auto schema = schemas_.find(bytes.number<std::uint16_t>());
      const std::string name(bytes.text()), encoding(bytes.text());
      channels_[id] = sink.topic({name, schema == schemas_.end() ? "" : schema->second, encoding});
    }
    if (!bytes.good()) throw damaged(at, "a description that ends early");
  }

  std::filesystem::path file_;
  FileWindow window_;
  bool finished_ = false;
  // How far it has been read: the next record, the CRC of all before, whether the data have ended.
  std::uint64_t next_ = kMagic.size();
  std::uint32_t crc_ = crc32_of(kMagic);
  bool ended_ = false;
  std::uint32_t index_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  // of the file, to topics of the bag
  Unpacker unpacker_;
  RawBuffer unpacked_;
};

}  // namespace

std::unique_ptr<BagFile> open_mcap_file(const std::filesystem::path& file) { return std::make_unique<McapFile>(file); }

}  // namespace rigproof

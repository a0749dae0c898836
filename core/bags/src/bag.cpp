#include "rigproof/bags/bag.h"

#include <algorithm>
#include <tuple>

#include "bag_file.h"
#include "bag_metadata.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "unpack.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<BagFile> open_bag_file(const fs::path& file, const fs::path& scratch, int unpacked_before = 0) {
  switch (container_of(file)) {
    case BagContainer::kMcap:
      return open_mcap_file(file);
    case BagContainer::kSqlite:
      return open_sqlite_file(file);
    case BagContainer::kRos1:
      throw Error(file.string() + ": is a bag of ROS 1; convert it: rosbags-convert --src " + file.filename().string() +
                  " --dst " + file.stem().string() + "  (pip install rosbags)");
    case BagContainer::kZstd: {
      if (unpacked_before > 0) throw Error(file.string() + ": is compressed twice; unpack it: zstd -d");
      require_disk_space(scratch.parent_path(), static_cast<double>(fs::file_size(file)));
      create_folder(scratch);
      const fs::path unpacked = scratch / file.stem();
      unpack_zstd_file(file, unpacked);
      return open_bag_file(unpacked, scratch, unpacked_before + 1);
    }
    case BagContainer::kNone:
      break;
  }
  std::error_code ignored;
  throw Error(file.string() + (fs::file_size(file, ignored) == 0 ? ": is empty" : ": is no bag") +
              "; an MCAP or SQLite file of rosbag2 was looked for");
}

}  // namespace

bool operator<(const BagPlace& a, const BagPlace& b) {
  return std::tie(a.file, a.chunk, a.offset) < std::tie(b.file, b.chunk, b.offset);
}

Bag::Bag(const fs::path& path, const fs::path& scratch) : path_(path), scratch_(scratch) {
  BagFiles found = find_bag_files(path);
  notes_ = std::move(found.notes);
  open_further(found.files);
}

void Bag::open_further(const std::vector<fs::path>& files) {
  for (std::size_t i = files_.size(); i < files.size(); ++i) {
    files_.push_back(open_bag_file(files[i], scratch_));
    names_.push_back(files[i]);
  }
}

bool Bag::goes_on() {
  BagFiles found = find_bag_files(path_);
  if (found.files.size() < names_.size() || !std::equal(names_.begin(), names_.end(), found.files.begin()))
    return false;
  for (std::size_t i = 0; i < files_.size(); ++i)
    if (container_of(names_[i]) == BagContainer::kZstd || !files_[i]->goes_on()) return false;
  notes_ = std::move(found.notes);
  open_further(found.files);
  return true;
}

Bag::~Bag() = default;

std::uint64_t Bag::size_bytes() const {
  std::uint64_t size = 0;
  for (const auto& file : files_) size += file->size_bytes();
  return size;
}

std::size_t Bag::topic_index(const BagTopic& topic) {
  const auto same = [&topic](const BagTopic& other) {
    return other.name == topic.name && other.type == topic.type && other.encoding == topic.encoding;
  };
  const auto found = std::find_if(topics_.begin(), topics_.end(), same);
  if (found != topics_.end()) return static_cast<std::size_t>(found - topics_.begin());
  topics_.push_back(topic);
  return topics_.size() - 1;
}

void Bag::note_progress(std::uint64_t bytes_of_file) {
  if (progress && !progress(bytes_before_ + bytes_of_file, size_bytes()))
    throw Error("interrupted", ExitCode::kTryAgain);
}

// A message that is compressed by itself begins with zstd's magic, which no encapsulation of CDR does.
void Bag::deliver(BagMessage message, const Take& take) {
  if (is_zstd(message.data)) {
    try {
      unpacked_ = unpack_zstd_message(message.data);
    } catch (const Error& error) {
      throw Error(topics_[message.topic].name + ": a compressed message: " + error.what());
    }
    message.data = unpacked_;
  }
  take(message);
}

void Bag::read(const std::function<bool(const BagTopic&)>& wants, const Take& take) {
  std::vector<bool> wanted;
  BagSink sink;
  sink.topic = [this](const BagTopic& topic) { return topic_index(topic); };
  sink.wants = [&](std::size_t topic) {
    while (wanted.size() <= topic) wanted.push_back(wants(topics_[wanted.size()]));
    return wanted[topic];
  };
  sink.take = [&](const BagMessage& message) { deliver(message, take); };
  sink.progress = [this](std::uint64_t bytes) { note_progress(bytes); };
  sink.note = [this](const std::string& note) { notes_.push_back(note); };
  sink.unpacked = [this](std::uint64_t bytes) { unpacked_bytes_ += bytes; };
  bytes_before_ = 0;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    files_[i]->read(static_cast<std::uint32_t>(i), sink);
    bytes_before_ += files_[i]->size_bytes();
  }
}

void Bag::read_at(std::vector<BagPlace> places, const Take& take) {
  std::sort(places.begin(), places.end());
  const auto same = [](const BagPlace& a, const BagPlace& b) { return !(a < b) && !(b < a); };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  BagSink sink;
  sink.wants = [](std::size_t) { return true; };
  sink.take = [&](const BagMessage& message) { deliver(message, take); };
  sink.progress = [](std::uint64_t) {};
  for (std::size_t begin = 0; begin < places.size();) {
    std::size_t end = begin;
    while (end < places.size() && places[end].file == places[begin].file) ++end;
    files_.at(places[begin].file)
        ->read_at(
            {places.begin() + static_cast<std::ptrdiff_t>(begin), places.begin() + static_cast<std::ptrdiff_t>(end)},
            sink);
    begin = end;
  }
}

}  // namespace rigproof

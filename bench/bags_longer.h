// Long bags out of short ones: the robot stands longer at each stop.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/bags/bag_writer.h"

namespace rigproof {

/// A message of a bag with what is needed to write it again.
struct KeptMessage {
  std::string topic, type;
  std::int64_t log_time_ns = 0;
  std::string data;
};
/// All of them.
std::vector<KeptMessage> messages_of(const std::filesystem::path& bag);

/// Each message again, `times` at 30 Hz, before the next stop begins: what has one time of recording is one stop.
/// Stamps of headers move with the times of recording; poses and pictures are the same.
void repeat_messages(const std::vector<KeptMessage>& messages, int times,
                     const std::function<void(const KeptMessage&)>& take);

/// FILE.mcap, or FILE.db3 (which ignores the packing and is held in memory).
void write_longer(const std::filesystem::path& from, int times, const std::filesystem::path& to, BagPacking packing);

}  // namespace rigproof

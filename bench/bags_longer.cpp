#include "bags_longer.h"

#include <algorithm>
#include <cstring>

#include "bag_bytes.h"
#include "rigproof/bags/bag.h"
#include "rigproof/bags/messages.h"

namespace rigproof {
namespace {

constexpr std::int64_t kNsPerS = 1000000000;
constexpr std::int64_t kPeriod_ns = kNsPerS / 30;

// The stamp behind the encapsulation, little-endian as rigproof writes it; what has no header first stays.
void move_stamp(std::int64_t by_ns, KeptMessage* message) {
  if (message->type == kTfType) return;
  const std::int64_t stamp = read_header(message->data).stamp_ns + by_ns;
  const auto seconds = static_cast<std::int32_t>(stamp / kNsPerS);
  const auto nanoseconds = static_cast<std::uint32_t>(stamp % kNsPerS);
  std::memcpy(message->data.data() + 4, &seconds, sizeof seconds);
  std::memcpy(message->data.data() + 8, &nanoseconds, sizeof nanoseconds);
}

}  // namespace

std::vector<KeptMessage> messages_of(const std::filesystem::path& bag) {
  Bag source(bag, std::filesystem::temp_directory_path() / "bench_bags");
  std::vector<KeptMessage> messages;
  source.read([](const BagTopic&) { return true; },
              [&](const BagMessage& message) {
                const BagTopic& topic = source.topics()[message.topic];
                messages.push_back({topic.name, topic.type, message.log_time_ns, std::string(message.data)});
              });
  return messages;
}

void repeat_messages(const std::vector<KeptMessage>& messages, int times,
                     const std::function<void(const KeptMessage&)>& take) {
  std::int64_t later_ns = 0;
  for (std::size_t begin = 0; begin < messages.size();) {
    std::size_t end = begin;
    while (end < messages.size() && messages[end].log_time_ns == messages[begin].log_time_ns) ++end;
    for (int time = 0; time < times; ++time)
      for (std::size_t i = begin; i < end; ++i) {
        KeptMessage message = messages[i];
        message.log_time_ns += later_ns + time * kPeriod_ns;
        move_stamp(later_ns + time * kPeriod_ns, &message);
        take(message);
      }
    later_ns += times * kPeriod_ns;
    begin = end;
  }
}

void write_longer(const std::filesystem::path& from, int times, const std::filesystem::path& to, BagPacking packing) {
  const std::vector<KeptMessage> messages = messages_of(from);
  if (to.extension() == ".db3") {
    std::vector<Recorded> rows;
    repeat_messages(messages, times, [&](const KeptMessage& message) {
      rows.push_back({message.topic, message.type, 1e-9 * static_cast<double>(message.log_time_ns), message.data});
    });
    return write_sqlite_bag(to, rows);
  }
  BagWriter writer(to, packing);
  repeat_messages(messages, times, [&](const KeptMessage& message) {
    writer.write(message.topic, message.type, message.log_time_ns, message.data);
  });
  writer.finish();
}

}  // namespace rigproof

// A file: magic, key, SHA-256 of the body, body. The body is numbers as they are in memory; run folders stay among
// machines of one byte order, and another one refuses the file by its magic's last number.
#include "drive_store.h"

#include <cstring>
#include <type_traits>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/generator/generator_version.h"
#include "rigproof/generator/parameters.h"

namespace rigproof {
namespace {

constexpr char kMagic[8] = {'R', 'P', 'D', 'R', 'I', 'V', 'E', '2'};
constexpr std::uint32_t kByteOrder = 0x01020304U;
constexpr std::size_t kHashDigits = 64;
constexpr std::size_t kHeadBytes = sizeof kMagic + sizeof kByteOrder + 2 * kHashDigits;
constexpr std::uintmax_t kMostBytes = 1U << 30U;

class Writer {
 public:
  template <typename Number>
  void number(const Number& value) {
    static_assert(std::is_arithmetic_v<Number>, "plain numbers only");
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void count(std::size_t& value) { number(static_cast<std::uint64_t>(value)); }
  void value(double& value) { number(value); }
  void value(int& value) { number(value); }
  void text(std::string& text) {
    std::size_t size = text.size();
    count(size);
    bytes += text;
  }
  template <typename T, typename Visit>
  void list(std::vector<T>& items, const Visit& visit) {
    std::size_t size = items.size();
    count(size);
    for (T& item : items) visit(item);
  }

  std::string bytes;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <typename Number>
  void number(Number* value) {
    if (rest_.size() < sizeof *value) throw Error("a drive ends too early");
    std::memcpy(value, rest_.data(), sizeof *value);
    rest_.remove_prefix(sizeof *value);
  }
  void count(std::size_t& value) {
    std::uint64_t wide = 0;
    number(&wide);
    value = static_cast<std::size_t>(wide);
  }
  void value(double& value) { number(&value); }
  void value(int& value) { number(&value); }
  void text(std::string& text) {
    std::size_t size = 0;
    count(size);
    if (size > rest_.size()) throw Error("a drive ends too early");
    text = rest_.substr(0, size);
    rest_.remove_prefix(size);
  }
  // Grows as it reads, so that a wrong number of items ends with the bytes instead of the memory.
  template <typename T, typename Visit>
  void list(std::vector<T>& items, const Visit& visit) {
    std::size_t size = 0;
    count(size);
    items.clear();
    for (std::size_t i = 0; i < size; ++i) visit(items.emplace_back());
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

// One list of members for both directions.
template <typename Archive>
void pass(Archive& archive, Rigid3& T) {
  for (int i = 0; i < 4; ++i) archive.value(T.rotation.coeffs()[i]);
  for (int i = 0; i < 3; ++i) archive.value(T.translation[i]);
}

template <typename Archive>
void pass(Archive& archive, ViewpointPlan& plan) {
  archive.list(plan.stops, [&](Viewpoint& stop) {
    for (double* number :
         {&stop.x_m, &stop.y_m, &stop.yaw_rad, &stop.distance_m, &stop.bearing_rad, &stop.obliquity_rad})
      archive.value(*number);
    archive.value(stop.cameras_with_board);
  });
  archive.count(plan.straight);
  archive.count(plan.skipped);
  archive.text(plan.coverage);
}

struct Sample {
  double stamp_s;
  Rigid3 T_scene_robot;
};

template <typename Archive>
void pass(Archive& archive, Drive& drive, std::vector<Sample>& trajectory) {
  archive.count(drive.ways_tried_again);
  archive.count(drive.given_up);
  pass(archive, drive.T_ground_robot);
  archive.list(drive.captures, [&](Capture& capture) {
    archive.value(capture.stamp_s);
    pass(archive, capture.T_scene_robot);
  });
  archive.list(drive.odometry, [&](OdometrySample& sample) {
    for (double* number : {&sample.stamp_s, &sample.x_m, &sample.y_m, &sample.yaw_rad}) archive.value(*number);
  });
  archive.list(trajectory, [&](Sample& sample) {
    archive.value(sample.stamp_s);
    pass(archive, sample.T_scene_robot);
  });
}

std::string head_of(const std::string& key, std::string_view body) {
  std::string head(kMagic, sizeof kMagic);
  head.append(reinterpret_cast<const char*>(&kByteOrder), sizeof kByteOrder);
  return head + key + sha256_hex(body);
}

}  // namespace

std::string drive_key(const GenerateConfig& config, const std::vector<ScenarioInput>& inputs) {
  GenerateConfig driven = without_sense_keys(config);
  driven.odometry.rate_hz = config.odometry.rate_hz;    // how often the drive is written down
  driven.sensing.time = GenerateConfig().sensing.time;  // cameras that are late do not drive elsewhere
  std::string text = generator_version() + " " + World::mujoco_version() + "\n";
  for (const ScenarioInput& input : inputs) text += input.sha256 + "\n";
  return sha256_hex(text + resolved_text(driven));
}

std::string encode_drive(const DrivenViewpoints& driven, const std::string& key) {
  DrivenViewpoints copy = driven;
  std::vector<Sample> trajectory;
  const std::vector<double>& stamps_s = driven.drive.trajectory.stamps_s();
  for (std::size_t i = 0; i < stamps_s.size(); ++i)
    trajectory.push_back({stamps_s[i], driven.drive.trajectory.poses()[i]});
  Writer writer;
  pass(writer, copy.plan);
  pass(writer, copy.drive, trajectory);
  return head_of(key, writer.bytes) + writer.bytes;
}

std::optional<DrivenViewpoints> decode_drive(std::string_view bytes, const std::string& key) {
  if (bytes.size() < kHeadBytes) return std::nullopt;
  const std::string_view body = bytes.substr(kHeadBytes);
  if (bytes.substr(0, kHeadBytes) != head_of(key, body)) return std::nullopt;
  try {
    DrivenViewpoints driven;
    std::vector<Sample> trajectory;
    Reader reader(body);
    pass(reader, driven.plan);
    pass(reader, driven.drive, trajectory);
    if (!reader.at_end()) return std::nullopt;
    for (const Sample& sample : trajectory) driven.drive.trajectory.add(sample.stamp_s, sample.T_scene_robot);
    return driven;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::filesystem::path drive_in_cache(const std::filesystem::path& cache, const std::string& key) {
  return cache / key.substr(0, 2) / (key.substr(2) + ".drive");
}

std::optional<DrivenViewpoints> find_drive(const std::vector<std::filesystem::path>& files, const std::string& key) {
  for (const std::filesystem::path& file : files) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) continue;
    try {
      const std::vector<std::uint8_t> bytes = read_binary_file(file, kMostBytes);
      std::optional<DrivenViewpoints> driven =
          decode_drive({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, key);
      if (driven) return driven;
    } catch (const Error&) {
      // Unreadable is as good as missing: the drive is simulated again.
    }
  }
  return std::nullopt;
}

}  // namespace rigproof

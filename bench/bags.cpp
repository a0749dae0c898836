// Reading bags: MCAP (plain, lz4, zstd) and SQLite against the decoders alone, in megabytes of messages a second.
//
//   bench_bags                                      pictures with noise, 190 MB, in the folder for temporary files
//   RIGPROOF_BENCH_BAG=FILE.mcap bench_bags         the messages of a bag of your own instead
//   bench_bags longer FILE.mcap TIMES TO.mcap|TO.db3 [none|lz4|zstd]
//                                                   makes a bag in which the robot stands so many times longer
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <lz4frame.h>
#include <stdlib.h>
#include <unistd.h>
#include <zstd.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <string>

#include "bag_bytes.h"
#include "bags_longer.h"
#include "rigproof/bags/bag.h"
#include "rigproof/bags/messages.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr int kPictures = 70;

// A ramp with noise of a few levels: packs to about half, as rooms do.
std::vector<KeptMessage> noisy_pictures() {
  constexpr std::uint32_t kWidth = 1280, kHeight = 720;
  RandomStream random(1, "bench");
  std::vector<KeptMessage> messages;
  std::string pixels(std::size_t{3} * kWidth * kHeight, '\0');
  std::vector<std::uint32_t> noise(pixels.size());
  for (int i = 0; i < kPictures; ++i) {
    random.fill(noise.data(), noise.size());
    for (std::size_t k = 0; k < pixels.size(); ++k)
      pixels[k] = static_cast<char>(60 + (k / 3 % kWidth) / 16 + noise[k] % 6);
    RosImage image;
    image.header.stamp_ns = i * 33333333LL;
    image.width = kWidth;
    image.height = kHeight;
    image.step = 3 * kWidth;
    image.encoding = "rgb8";
    image.data = pixels;
    messages.push_back({"/left/image_raw", kImageType, image.header.stamp_ns, message_bytes(image)});
  }
  return messages;
}

/// The same messages in every container, made once and removed at the end.
class Bags {
 public:
  Bags() {
    std::string name = (fs::temp_directory_path() / "bench_bags_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error("cannot create " + name);
    folder_ = name;
    const char* given = std::getenv("RIGPROOF_BENCH_BAG");
    messages_ = given != nullptr ? messages_of(given) : noisy_pictures();
    for (const KeptMessage& message : messages_) bytes_ += message.data.size();
  }
  ~Bags() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Bags(const Bags&) = delete;
  Bags& operator=(const Bags&) = delete;

  double megabytes() const { return 1e-6 * static_cast<double>(bytes_); }
  const std::vector<KeptMessage>& messages() const { return messages_; }
  fs::path file(const std::string& name) {
    const fs::path path = folder_ / name;
    if (fs::exists(path)) return path;
    if (path.extension() == ".db3") {
      std::vector<Recorded> rows;
      for (const KeptMessage& message : messages_)
        rows.push_back({message.topic, message.type, 1e-9 * static_cast<double>(message.log_time_ns), message.data});
      write_sqlite_bag(path, rows);
      return path;
    }
    BagWriter writer(path, name == "lz4.mcap"    ? BagPacking::kLz4
                           : name == "zstd.mcap" ? BagPacking::kZstd
                                                 : BagPacking::kNone);
    for (const KeptMessage& message : messages_)
      writer.write(message.topic, message.type, message.log_time_ns, message.data);
    writer.finish();
    return path;
  }

 private:
  fs::path folder_;
  std::vector<KeptMessage> messages_;
  std::uint64_t bytes_ = 0;
};

std::unique_ptr<Bags>& bags() {
  static std::unique_ptr<Bags> all;
  if (!all) all = std::make_unique<Bags>();
  return all;
}

void count(benchmark::State& state, double megabytes) {
  state.counters["MB/s"] =
      benchmark::Counter(megabytes * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["MB"] = megabytes;
}

// All messages, of which the first bytes are looked at.
void read(benchmark::State& state, const std::string& name) {
  const fs::path file = bags()->file(name);
  for (auto _ : state) {
    Bag bag(file, fs::temp_directory_path() / "bench_bags");
    std::size_t stamps = 0;
    bag.read([](const BagTopic&) { return true; },
             [&](const BagMessage& message) { stamps += static_cast<unsigned char>(message.data[4]); });
    benchmark::DoNotOptimize(stamps);
  }
  count(state, bags()->megabytes());
  state.counters["file_MB"] = 1e-6 * static_cast<double>(fs::file_size(file));
}

// What no reader can be faster than: the bytes out of the file, into one piece of memory.
void bare_file(benchmark::State& state, const std::string& name) {
  const fs::path file = bags()->file(name);
  std::string piece(4U << 20U, '\0');
  for (auto _ : state) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    while (::read(descriptor, piece.data(), piece.size()) > 0) benchmark::DoNotOptimize(piece.data());
    ::close(descriptor);
  }
  count(state, 1e-6 * static_cast<double>(fs::file_size(file)));
}

// The messages in pieces of a chunk's size, packed one by one as the writer does.
std::vector<std::string> chunks() {
  std::vector<std::string> result(1);
  for (const KeptMessage& message : bags()->messages()) {
    if (result.back().size() > (4U << 20U)) result.emplace_back();
    result.back() += message.data;
  }
  return result;
}

void bare_zstd(benchmark::State& state) {
  std::vector<std::pair<std::string, std::size_t>> packed;
  for (const std::string& chunk : chunks()) packed.emplace_back(zstd_packed(chunk), chunk.size());
  std::string to(64U << 20U, '\0');
  ZSTD_DCtx* context = ZSTD_createDCtx();
  for (auto _ : state)
    for (const auto& [bytes, size] : packed)
      if (ZSTD_decompressDCtx(context, to.data(), to.size(), bytes.data(), bytes.size()) != size) std::abort();
  ZSTD_freeDCtx(context);
  count(state, bags()->megabytes());
}

void bare_lz4(benchmark::State& state) {
  std::vector<std::string> packed;
  for (const std::string& chunk : chunks()) {
    packed.emplace_back(LZ4F_compressFrameBound(chunk.size(), nullptr), '\0');
    packed.back().resize(
        LZ4F_compressFrame(packed.back().data(), packed.back().size(), chunk.data(), chunk.size(), nullptr));
  }
  std::string to(64U << 20U, '\0');
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) std::abort();
  for (auto _ : state)
    for (const std::string& bytes : packed) {
      std::size_t target = to.size(), source = bytes.size();
      if (LZ4F_decompress(context, to.data(), &target, bytes.data(), &source, nullptr) != 0) std::abort();
    }
  LZ4F_freeDecompressionContext(context);
  count(state, bags()->megabytes());
}

BENCHMARK_CAPTURE(bare_file, plain, "plain.mcap")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, plain, "plain.mcap")->Unit(benchmark::kMillisecond);
BENCHMARK(bare_lz4)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, lz4, "lz4.mcap")->Unit(benchmark::kMillisecond);
BENCHMARK(bare_zstd)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, zstd, "zstd.mcap")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, sqlite, "rows.db3")->Unit(benchmark::kMillisecond);

int make_longer(int argc, char** argv) {
  const std::map<std::string, BagPacking> packings = {
      {"none", BagPacking::kNone}, {"lz4", BagPacking::kLz4}, {"zstd", BagPacking::kZstd}};
  const auto packing = packings.find(argc > 5 ? argv[5] : "none");
  if (argc < 5 || packing == packings.end()) {
    std::fprintf(stderr, "usage: bench_bags longer FILE.mcap TIMES TO.mcap|TO.db3 [none|lz4|zstd]\n");
    return 2;
  }
  write_longer(argv[2], std::atoi(argv[3]), argv[4], packing->second);
  return 0;
}

}  // namespace
}  // namespace rigproof

int main(int argc, char** argv) {
  try {
    if (argc > 1 && std::string(argv[1]) == "longer") return rigproof::make_longer(argc, argv);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    rigproof::bags().reset();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}

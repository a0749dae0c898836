// bench_observe RECORDING [threads]: observing a recording against merely decoding its images with OpenCV, in one run.
#include "rigproof/calib/vision/observe.h"

#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "clocks.h"
#include "rigproof/formats/format.h"

namespace {

using namespace rigproof;

void decode_all(const std::vector<std::string>& files, int flags, int threads) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t i = next++; i < files.size(); i = next++)
      if (cv::imread(files[i], flags).empty()) std::fprintf(stderr, "cannot read %s\n", files[i].c_str());
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
}

void measure(const Recording& recording, int threads) {
  std::vector<std::string> color, depth;
  for (const auto& frames : recording.frames) {
    for (const CameraFrame& frame : frames) {
      color.push_back((recording.folder / frame.color_file).string());
      if (!frame.depth_file.empty()) depth.push_back((recording.folder / frame.depth_file).string());
    }
  }
  cv::setNumThreads(1);
  ObserveOptions options, colour_only;
  options.threads = colour_only.threads = threads;
  colour_only.use_depth = false;
  // The machine's other work and the page cache change slowly: the best of three interleaved rounds of each.
  double decode_color = 1e9, decode_depth = 1e9, boards = 1e9, all = 1e9;
  for (int round = 0; round < 3; ++round) {
    decode_color = std::min(decode_color, seconds_of([&] { decode_all(color, cv::IMREAD_GRAYSCALE, threads); }));
    boards = std::min(boards, seconds_of([&] { observe(recording, colour_only); }));
    decode_depth = std::min(decode_depth, seconds_of([&] { decode_all(depth, cv::IMREAD_UNCHANGED, threads); }));
    all = std::min(all, seconds_of([&] { observe(recording, options); }));
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%zu colour and %zu depth images, %d threads\n", color.size(), depth.size(), threads);
  std::printf("decode colour   %.3f s   observe without depth %.3f s   ratio %.2f\n", decode_color, boards,
              boards / decode_color);
  std::printf("decode both     %.3f s   observe               %.3f s   ratio %.2f\n", decode_color + decode_depth, all,
              all / (decode_color + decode_depth));
  std::printf("observe with depth against decoding colour alone: ratio %.2f\n", all / decode_color);
  std::printf("peak memory     %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_observe RECORDING [threads]\n");
    return 2;
  }
  try {
    const Input input = open_input(argv[1]);
    if (!input.recording) {
      std::fprintf(stderr, "%s holds no images\n", argv[1]);
      return 2;
    }
    measure(*input.recording, argc > 2 ? std::atoi(argv[2]) : 2);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}

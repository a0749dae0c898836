// Throughput of a whole generation against the bare passes, rendered and read back, in as many processes; and memory.
//
//   bench_generation [throughput] [POSES=100] [ROUNDS=3] [key: value ..]   wall time and CPU time, and their ratio
//   bench_generation memory [FEW=100] [MANY=2000] [key: value ..]          largest resident set, one run after the
//   other
//
// Further arguments are lines of a run's configuration, e.g. "sensor_noise: none" or "image_scale: 0.5".
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "bare_passes.h"
#include "clocks.h"
#include "rigproof/core/error.h"
#include "rigproof/generator/generate.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "run_arguments.h"

namespace {

using namespace rigproof;

struct Cost {
  double wall_s = 0.0, cpu_s = 0.0;
  long largest_kb = 0;
};

// Runs the work in a process of its own, so that its descendants' costs can be told apart.
template <typename Work>
Cost measure(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t pid = ::fork();
  if (pid == 0) {
    try {
      work();
    } catch (const Error& error) {
      std::fprintf(stderr, "%s\n", error.what());
      ::_exit(1);
    }
    rusage children{}, self{};
    ::getrusage(RUSAGE_CHILDREN, &children);
    ::getrusage(RUSAGE_SELF, &self);
    std::printf("  main process %ld MB, render process %ld MB\n", self.ru_maxrss / 1024, children.ru_maxrss / 1024);
    std::fflush(stdout);
    ::_exit(0);
  }
  int status = 0;
  rusage usage{};
  ::wait4(pid, &status, 0, &usage);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) std::exit(1);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {wall_s, seconds(usage.ru_utime) + seconds(usage.ru_stime), usage.ru_maxrss};
}

int processes() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

Cost generate_once(const GenerateConfig& config) {
  const ScratchFolder folder("bench-generation");
  GenerateOptions options;
  options.output = folder.path() / "run";  // the folder itself is locked
  options.jobs = processes();
  return measure([&] { generate(config, options); });
}

void throughput(const GenerateConfig& config, int rounds) {
  const double images = 3.0 * static_cast<double>(config.poses);
  std::vector<double> wall_ratios, cpu_ratios;
  for (int round = 0; round < rounds; ++round) {
    const Cost bare = measure([&] { render_bare(resolve_scenario(config), processes()); });
    const Cost whole = generate_once(config);
    wall_ratios.push_back(bare.wall_s / whole.wall_s);
    cpu_ratios.push_back(bare.cpu_s / whole.cpu_s);
    std::printf(
        "bare %.1f images/s, %.1f ms CPU an image; generate %.1f images/s, %.1f ms CPU; ratio %.3f (CPU %.3f)\n",
        images / bare.wall_s, 1e3 * bare.cpu_s / images, images / whole.wall_s, 1e3 * whole.cpu_s / images,
        wall_ratios.back(), cpu_ratios.back());
    std::fflush(stdout);
  }
  std::sort(wall_ratios.begin(), wall_ratios.end());
  std::sort(cpu_ratios.begin(), cpu_ratios.end());
  std::printf("median ratio %.3f (CPU %.3f), goal 0.65\n", wall_ratios[wall_ratios.size() / 2],
              cpu_ratios[cpu_ratios.size() / 2]);
}

void memory(GenerateConfig config, const std::vector<int>& poses) {
  for (const int count : poses) {
    config.poses = count;
    const Cost cost = generate_once(config);
    std::printf("%d poses: largest process %ld MB, %.1f s\n", count, cost.largest_kb / 1024, cost.wall_s);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    auto [numbers, words, config] = parse_run_arguments(argc, argv, {"throughput", "memory"});
    if (std::find(words.begin(), words.end(), "memory") != words.end()) {
      memory(config, numbers.empty() ? std::vector<int>{100, 2000} : numbers);
    } else {
      if (!numbers.empty()) config.poses = numbers[0];
      throughput(config, numbers.size() > 1 ? numbers[1] : 3);
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}

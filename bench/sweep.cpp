// What the machinery of a sweep costs beside its tasks, and what a second worker gains.
//   bench_sweep [tasks, default 1000] [poses, default 100]
// Geometric tasks answered by `ml`: in a bare loop of one process without files, then as `rigproof sweep run`, with one
// and with two workers, in folders of their own. Processor time is what counts on a machine that is not quiet.
#include "rigproof/study/sweep/sweep.h"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "clocks.h"
#include "rigproof/core/child_process.h"
#include "rigproof/study/workflow/external.h"
#include "temp_folder.h"
#include "work.h"

namespace rigproof {
namespace {

struct Times {
  double wall_s = 0.0, cpu_s = 0.0;
};

template <typename Work>
Times measured(const Work& work) {
  const double cpu = cpu_s();
  const double wall_s = seconds_of([&work] {
    ChildProcess child([&work] {
      work();
      return 0;
    });
    if (!child.wait().is_good()) std::abort();
  });
  return {wall_s, cpu_s() - cpu};
}

void bare_loop(const SweepConfig& config, const std::vector<SweepTask>& tasks, const SweepCache& none) {
  const auto method = methods_by_name({"ml"}, ExternalOptions()).front();
  const SweepSight sight{SweepVision()};
  const Count count = [](const std::string&, std::uint64_t) {};
  for (const SweepTask& task : tasks) answer_of(*method, data_of(config, task, none, count, {}), sight);
}

void measure(int tasks, int poses) {
  const TempFolder folder;
  const SweepConfig config =
      load_sweep_config(folder.write("bench.yaml", "mode: geometric\nrun: {poses: " + std::to_string(poses) +
                                                       "}\nseeds: " + std::to_string(tasks) + "\n"));
  const std::vector<SweepTask> planned = plan_sweep(config);
  const SweepCache none(folder / "none");
  const auto sweep = [&](const char* name, int jobs) {
    SweepOptions options;
    options.folder = folder / name;
    options.jobs = jobs;
    plan_folder(config, options);
    return measured([&] { run_shard(options, {}); });
  };
  const Times bare = measured([&] { bare_loop(config, planned, none); });
  const Times one = sweep("one", 1), two = sweep("two", 2);
  std::printf("%d tasks of %d poses\n", tasks, poses);
  std::printf("bare loop    %7.1f s  %7.1f s of processor\n", bare.wall_s, bare.cpu_s);
  std::printf("one worker   %7.1f s  %7.1f s of processor: %+.1f %%\n", one.wall_s, one.cpu_s,
              100.0 * (one.cpu_s / bare.cpu_s - 1.0));
  std::printf("two workers  %7.1f s  %7.1f s of processor: %.2f times as fast as one\n", two.wall_s, two.cpu_s,
              one.wall_s / two.wall_s);
}

}  // namespace
}  // namespace rigproof

int main(int argc, char** argv) {
  rigproof::measure(argc > 1 ? std::atoi(argv[1]) : 1000, argc > 2 ? std::atoi(argv[2]) : 100);
  return 0;
}

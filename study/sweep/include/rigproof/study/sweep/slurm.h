// Scripts that run a planned sweep as a job array of Slurm.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace rigproof {

struct SlurmJob {
  std::filesystem::path program;     ///< rigproof, as the nodes find it
  std::filesystem::path folder;      ///< of a planned sweep, shared by the nodes
  std::filesystem::path cache;       ///< empty = cache/ in the folder
  std::size_t array = 0;             ///< array tasks, each a shard; 0 = one for every 100 tasks, at most 1000
  std::size_t throttle = 0;          ///< array tasks at once; 0 = as many as Slurm gives
  std::size_t cpus = 2;              ///< of an array task
  std::vector<std::string> options;  ///< of sbatch, for array and merge: "--partition=long"
};

struct SlurmScripts {
  std::filesystem::path run, merge;
  std::filesystem::path submit;  ///< hands both to Slurm
  std::size_t array = 0;
};

/// Writes slurm/run.sbatch, slurm/merge.sbatch and slurm/submit in the sweep's folder. Throws Error.
SlurmScripts write_slurm_scripts(const SlurmJob& job);

}  // namespace rigproof

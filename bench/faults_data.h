// The recordings that bench_faults breaks: rendered drives of three rigs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rigproof::bench {

/// husky: three cameras, all with depth; cart: one with depth, a fisheye without, one that looks back; single: one.
const std::vector<std::string>& fault_rigs();

struct DriveKind {
  std::string name;  ///< behind those of its runs
  double image_scale = 0.5;
  int stops = 16;
  std::string pictures = "plain";  ///< what a run's configuration includes
};

/// DATA/RIG-SEED, with the name of the kind: a run as `rigproof generate` makes it, in a world that the seed chooses.
/// Generated, or resumed, unless it is there. Throws Error.
std::filesystem::path drive_of(const std::filesystem::path& data, const std::string& rig, std::uint64_t seed,
                               const DriveKind& kind);

/// The same drive with these of faults::variants(), each in DATA/RIG-SEED-VARIANT.
void add_variants(const std::filesystem::path& run, const std::string& rig, std::uint64_t seed, const DriveKind& kind,
                  const std::set<std::string>& names);

}  // namespace rigproof::bench

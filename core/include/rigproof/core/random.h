// Counter-based random streams: what a stream yields depends on (seed, purpose, frame, camera) alone, never on the
// order or the thread in which streams are drawn.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rigproof {

/// Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"): four random words of a counter.
std::array<std::uint32_t, 4> philox4x32(const std::array<std::uint32_t, 4>& counter,
                                        const std::array<std::uint32_t, 2>& key);

/// Philox keyed by the seed and the purpose, with frame and camera in the counter. Cheap to create.
class RandomStream {
 public:
  /// @param purpose what the numbers are for, e.g. "odometry"; streams of different purposes are independent.
  /// @param frame, camera -1 where they do not apply.
  RandomStream(std::uint64_t seed, std::string_view purpose, std::int64_t frame = -1, std::int32_t camera = -1);

  std::uint32_t next_u32();
  /// The same numbers as `count` calls of next_u32(), several times faster: for noise on every pixel.
  void fill(std::uint32_t* words, std::size_t count);
  /// Uniform in [0, 1) with 53 bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box-Muller; both values are used).
  double normal();
  double normal(double mean, double standard_deviation) { return mean + standard_deviation * normal(); }
  /// Uniform integer in [0, count), count > 0, without modulo bias.
  std::uint32_t below(std::uint32_t count);

 private:
  void refill();

  std::uint32_t key_[2];
  std::uint32_t counter_[4];
  std::uint32_t block_[4];
  int used_ = 4;
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

}  // namespace rigproof

#include "row_filters.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "rigproof/core/vector_clones.h"

namespace rigproof::png_detail {
namespace {

std::uint8_t wrap(int value) { return static_cast<std::uint8_t>(value); }

std::uint8_t paeth(int a, int b, int c) {
  const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
  return wrap(pa <= pb && pa <= pc ? a : pb <= pc ? b : c);
}

// Step is a template argument so that the neighbour of a pixel stays in registers.
template <std::size_t Step>
bool unfilter_row(const std::uint8_t* above, std::uint8_t* row, int filter, std::size_t size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      for (std::size_t i = Step; i < size; ++i) row[i] = wrap(row[i] + row[i - Step]);
      return true;
    case 2:
      for (std::size_t i = 0; i < size; ++i) row[i] = wrap(row[i] + above[i]);
      return true;
    case 3:
      for (std::size_t i = 0; i < Step; ++i) row[i] = wrap(row[i] + above[i] / 2);
      for (std::size_t i = Step; i < size; ++i) row[i] = wrap(row[i] + (row[i - Step] + above[i]) / 2);
      return true;
    case kFilterPaeth:
      for (std::size_t i = 0; i < Step; ++i) row[i] = wrap(row[i] + above[i]);
      for (std::size_t i = Step; i < size; ++i) row[i] = wrap(row[i] + paeth(row[i - Step], above[i], above[i - Step]));
      return true;
    default:
      return false;
  }
}

// Vectors of the compiler (g++ and clang): SSE2 on x86-64, NEON on ARM.
using Bytes8 = std::uint8_t __attribute__((vector_size(8)));
using Lanes = std::int16_t __attribute__((vector_size(16)));

Lanes widen(std::uint64_t bytes) {
  Bytes8 vector;
  std::memcpy(&vector, &bytes, sizeof vector);
  return __builtin_convertvector(vector, Lanes);
}

Lanes absolute(Lanes v) { return v > -v ? v : -v; }

Lanes choose(Lanes mask, Lanes yes, Lanes no) { return (mask & yes) | (~mask & no); }

// Several Paeth rows at a time. A pixel has to wait for its left neighbour, so that one row alone leaves a processor
// idle; here each row runs one pixel behind the row above it, and one vector holds a pixel of every row. What is above
// a pixel was made one step before, one slot further down; little-endian, as every machine that this builds for.
template <std::size_t Step>
class PaethRows {
  static constexpr std::size_t kSlot = Step <= 2 ? Step : Step <= 4 ? 4 : 8;  // lanes of a pixel

 public:
  static constexpr std::size_t kRows = 8 / kSlot;

  PaethRows(const std::uint8_t* above, std::uint8_t* lines, std::size_t bytes)
      : above_(above), first_(lines + 1), pitch_(bytes + 1), width_(bytes / Step) {}

  void run() {
    State state{};
    std::size_t t = 0;
    for (; t < std::min(kRows - 1, width_); ++t) step<true>(t, &state);
    for (; t < width_; ++t) step<false>(t, &state);
    for (; t < width_ + kRows - 1; ++t) step<true>(t, &state);
  }

 private:
  struct State {
    Lanes made{}, above{};  ///< of the step before
  };

  static std::uint64_t load_pixel(const std::uint8_t* from) {
    std::uint64_t pixel = 0;
    std::memcpy(&pixel, from, kSlot);  // a byte of the next pixel does no harm
    return pixel;
  }

  // The row above all rows enters in the first slot.
  template <std::size_t... I>
  static Lanes one_row_down(Lanes made, Lanes entering, std::index_sequence<I...>) {
    return __builtin_shufflevector(made, entering,
                                   (I < kSlot ? static_cast<int>(8 + I) : static_cast<int>(I - kSlot))...);
  }

  template <bool Edge>
  bool inside(std::size_t t, std::size_t row) const {
    return !Edge || (t >= row && t - row < width_);
  }

  template <bool Edge>
  void step(std::size_t t, State* state) const {
    std::uint64_t raw = 0, valid = 0;
    for (std::size_t row = 0; row < kRows; ++row) {
      if (!inside<Edge>(t, row)) continue;
      raw |= load_pixel(pixel(row, t)) << (8 * kSlot * row % 64);
      valid |= (~std::uint64_t{0} >> (64 - 8 * kSlot)) << (8 * kSlot * row % 64);
    }
    const Lanes entering = widen(inside<Edge>(t, 0) ? load_pixel(above_ + Step * t) : 0);
    const Lanes a = state->made, b = one_row_down(a, entering, std::make_index_sequence<8>()), c = state->above;
    const Lanes to_a = absolute(b - c), to_b = absolute(a - c), to_c = absolute((b - c) + (a - c));
    const Lanes predicted = choose((to_a <= to_b) & (to_a <= to_c), a, choose(to_b <= to_c, b, c));
    Lanes made = (widen(raw) + predicted) & 255;
    if (Edge) made = made & widen(valid);  // zero left of a row
    const Bytes8 narrow = __builtin_convertvector(made, Bytes8);
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, &narrow, sizeof bytes);
    for (std::size_t row = 0; row < kRows; ++row) {
      if (!inside<Edge>(t, row)) continue;
      const std::uint64_t made_pixel = bytes >> (8 * kSlot * row % 64);
      std::memcpy(pixel(row, t), &made_pixel, Step);
    }
    *state = {made, b};
  }

  std::uint8_t* pixel(std::size_t row, std::size_t t) const { return first_ + row * pitch_ + Step * (t - row); }

  const std::uint8_t* above_;
  std::uint8_t* first_;
  std::size_t pitch_, width_;
};

template <std::size_t Step>
std::size_t unfilter(const std::uint8_t* above, std::uint8_t* lines, std::size_t rows, std::size_t bytes) {
  constexpr std::size_t kRows = PaethRows<Step>::kRows;
  bool all_paeth = rows >= kRows;
  for (std::size_t row = 0; row < kRows && all_paeth; ++row) all_paeth = lines[row * (bytes + 1)] == kFilterPaeth;
  if (!all_paeth) return unfilter_row<Step>(above, lines + 1, lines[0], bytes) ? 1 : 0;
  PaethRows<Step>(above, lines, bytes).run();
  return kRows;
}

}  // namespace

RIGPROOF_VECTOR_CLONES
void filter_paeth_row(const std::uint8_t* __restrict__ row, const std::uint8_t* __restrict__ above, std::size_t bytes,
                      std::size_t pixel_bytes, std::uint8_t* __restrict__ out) {
  for (std::size_t i = 0; i < pixel_bytes; ++i) out[i] = wrap(row[i] - above[i]);
  const std::uint8_t *left = row - pixel_bytes, *corner = above - pixel_bytes;
  for (std::size_t i = pixel_bytes; i < bytes; ++i) {
    // 16 bits suffice and are vectorised.
    const auto a = static_cast<std::int16_t>(left[i]), b = static_cast<std::int16_t>(above[i]);
    const auto c = static_cast<std::int16_t>(corner[i]);
    const auto to_a = static_cast<std::int16_t>(std::abs(b - c)), to_b = static_cast<std::int16_t>(std::abs(a - c));
    const auto to_c = static_cast<std::int16_t>(std::abs(a + b - 2 * c));
    const std::int16_t second = to_b <= to_c ? b : c;
    const bool nearest = (to_a <= to_b) & (to_a <= to_c);
    const std::int16_t predicted = nearest ? a : second;
    out[i] = static_cast<std::uint8_t>(row[i] - predicted);
  }
}

std::size_t unfilter_rows(const std::uint8_t* above, std::uint8_t* lines, std::size_t rows, std::size_t bytes,
                          std::size_t pixel_bytes) {
  switch (pixel_bytes) {
    case 1:
      return unfilter<1>(above, lines, rows, bytes);
    case 2:
      return unfilter<2>(above, lines, rows, bytes);
    case 3:
      return unfilter<3>(above, lines, rows, bytes);
    case 4:
      return unfilter<4>(above, lines, rows, bytes);
    case 6:
      return unfilter<6>(above, lines, rows, bytes);
    default:
      return unfilter<8>(above, lines, rows, bytes);
  }
}

}  // namespace rigproof::png_detail

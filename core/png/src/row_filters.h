// PNG's filters of rows (ISO/IEC 15948, 9): what is compressed are differences to predictions from neighbours.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigproof::png_detail {

/// Filter 4, "Paeth": the difference to the neighbour, left, above or above left, that is nearest to what a plane
/// through the three predicts.
inline constexpr std::uint8_t kFilterPaeth = 4;

/// Filters a row into `out`. `above` is the row before, as it was; zero on the first row.
void filter_paeth_row(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes, std::size_t pixel_bytes,
                      std::uint8_t* out);

/// Bytes that must be readable behind the last row and behind `above`.
inline constexpr std::size_t kUnfilterPadding = 8;

/// Takes the filters off one or several rows, in place. `lines` begins at the filter byte of a row and has `rows` rows
/// of 1 + `bytes`; `above` is the row before, without its filter byte. Returns how many rows are done, at least one; 0
/// if the first one's filter is unknown.
std::size_t unfilter_rows(const std::uint8_t* above, std::uint8_t* lines, std::size_t rows, std::size_t bytes,
                          std::size_t pixel_bytes);

}  // namespace rigproof::png_detail

#include "board_coverage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr std::size_t kGuessedImages = 8;  // of each camera: finding a board of unknown size takes a second

std::vector<std::size_t> stops_with(const std::vector<BoardView>& views, std::size_t cameras) {
  std::vector<std::set<int>> stops(cameras);
  for (const BoardView& view : views) stops[static_cast<std::size_t>(view.camera)].insert(view.stop);
  std::vector<std::size_t> counts;
  for (const auto& some : stops) counts.push_back(some.size());
  return counts;
}

std::string squares_text(int columns, int rows) {
  return "squares: [" + std::to_string(columns) + ", " + std::to_string(rows) + "]";
}

// As rig.yaml says it, with squares of 100 mm.
std::string text_of(const Board& board) {
  const std::string text =
      "type: " + board.type + ", " + squares_text(board.squares_x, board.squares_y) + ", square_mm: 100";
  if (board.type == "checkerboard") return text;
  const std::string marker = ", marker_mm: " + number_text(std::round(100.0 * board.marker_side_m() / board.square_m));
  if (board.has_tags()) return text + marker;
  return text + marker + ", dictionary: " + board.dictionary + (board.legacy_pattern ? ", legacy_pattern: true" : "");
}

void interrupt() { throw Error("interrupted", ExitCode::kTryAgain); }

}  // namespace

std::optional<Board> any_board(const Image8& image) {
  // First the one with markers: its corners alone look like a checkerboard's.
  if (std::optional<Board> board = find_any_marked_board(image)) return board;
  const auto size = find_any_checkerboard(image);
  if (!size) return std::nullopt;
  Board board;
  board.squares_x = size->inner_corners_long + 1;
  board.squares_y = size->inner_corners_short + 1;
  return board;
}

BoardCoverage find_board(const Recording& recording, int threads, const CoverageProgress& progress) {
  BoardCoverage coverage;
  const std::size_t cameras = recording.rig.cameras.size();
  ObserveOptions options;
  options.threads = threads;
  options.use_depth = false;
  if (progress) options.progress = [&progress](std::size_t done, std::size_t total) { return progress(done, total); };
  try {
    const Observations observations = observe(recording, options);
    coverage.stops = stops_with(observations.board_views, cameras);
    coverage.looked_at.assign(cameras, observations.stops.size());
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    coverage = guess_board(recording, progress);  // in no image: it may be another one
    coverage.stops.assign(cameras, 0);
  }
  return coverage;
}

BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress) {
  BoardCoverage coverage;
  std::map<std::string, int> votes;
  const std::size_t total = kGuessedImages * recording.frames.size();
  std::size_t done = 0;
  for (const std::vector<CameraFrame>& frames : recording.frames) {
    std::size_t seen = 0, looked_at = 0;
    const std::size_t count = std::min(kGuessedImages, frames.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (progress && !progress(done++, total)) interrupt();
      const auto image = read_grey_image(path_inside(recording.folder, frames[i * frames.size() / count].color_file));
      if (!std::holds_alternative<Image8>(image)) continue;
      ++looked_at;
      const std::optional<Board> board = any_board(std::get<Image8>(image));
      if (!board) continue;
      ++seen;
      ++votes[text_of(*board)];
    }
    coverage.stops.push_back(seen);
    coverage.looked_at.push_back(looked_at);
  }
  const auto most =
      std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != votes.end()) coverage.seen = most->first;
  return coverage;
}

}  // namespace rigproof

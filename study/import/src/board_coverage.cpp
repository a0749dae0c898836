#include "board_coverage.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>
#include <set>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/image_cell.h"
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

std::vector<std::size_t> cells_with(const std::vector<BoardView>& views, const std::vector<RigCamera>& cameras) {
  std::vector<std::bitset<kImageCells>> cells(cameras.size());
  for (const BoardView& view : views) {
    const auto camera = static_cast<std::size_t>(view.camera);
    for (const CornerObservation& corner : view.corners)
      cells[camera].set(image_cell(cameras[camera].camera, corner.pixel));
  }
  std::vector<std::size_t> counts;
  for (const auto& some : cells) counts.push_back(some.count());
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

struct Candidate {
  Board board;
  int images = 0;
};
using Candidates = std::map<std::string, Candidate>;  // by their text

// In the order of how many images show them. Candidates that images do not tell from one another are one board: a part
// of it looks like a smaller one with the same markers, and how large its markers are is read to a hundredth.
/// @param known boards that are not meant
std::vector<std::string> told_apart(const Candidates& candidates, const std::vector<Board>& known) {
  constexpr int kOfFurther = 2;  // images that show a board beside another one
  std::vector<std::pair<std::string, Candidate>> order(candidates.begin(), candidates.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second.images > b.second.images; });
  const auto same = [](const Board& a, const Board& b) { return problem_of_telling_apart(a, b).has_value(); };
  std::vector<std::pair<std::string, Candidate>> groups;
  for (const auto& [text, candidate] : order) {
    const Board& board = candidate.board;
    if (std::any_of(known.begin(), known.end(), [&](const Board& other) { return same(other, board); })) continue;
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const auto& other) { return same(other.second.board, board); });
    if (group == groups.end())
      groups.emplace_back(text, candidate);
    else
      group->second.images += candidate.images;
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.second.images > b.second.images; });
  std::vector<std::string> seen;
  for (const auto& [text, candidate] : groups)
    if ((known.empty() && seen.empty()) || candidate.images >= kOfFurther) seen.push_back(text);
  return seen;
}

void interrupt() { throw Error("interrupted", ExitCode::kTryAgain); }

/// @param which cameras to look through; empty: all
/// @param known boards that are not meant
BoardCoverage guessed(const Recording& recording, const std::vector<bool>& which, const std::vector<Board>& known,
                      const CoverageProgress& progress) {
  BoardCoverage coverage;
  Candidates candidates;
  std::size_t done = 0, total = 0;
  for (std::size_t c = 0; c < recording.frames.size(); ++c)
    total += which.empty() || which[c] ? std::min(kGuessedImages, recording.frames[c].size()) : 0;
  for (std::size_t c = 0; c < recording.frames.size(); ++c) {
    const std::vector<CameraFrame>& frames = recording.frames[c];
    std::size_t seen = 0, looked_at = 0;
    const std::size_t count = which.empty() || which[c] ? std::min(kGuessedImages, frames.size()) : 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (progress && !progress(done++, total)) interrupt();
      const auto image = read_grey_image(path_inside(recording.folder, frames[i * frames.size() / count].color_file));
      if (!std::holds_alternative<Image8>(image)) continue;
      ++looked_at;
      const std::optional<Board> board = any_board(std::get<Image8>(image));
      if (!board) continue;
      ++seen;
      Candidate& candidate = candidates[text_of(*board)];
      candidate.board = *board;
      ++candidate.images;
    }
    coverage.stops.push_back(seen);
    coverage.looked_at.push_back(looked_at);
  }
  coverage.seen = told_apart(candidates, known);
  return coverage;
}

std::vector<Board> boards_of(const Rig& rig) {
  std::vector<Board> boards = rig.more_boards;
  boards.insert(boards.begin(), rig.board);
  return boards;
}

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
    coverage.cells = cells_with(observations.board_views, recording.rig.cameras);
    coverage.looked_at.assign(cameras, observations.stops.size());
  } catch (const FindingError& error) {
    if (!error.finding().is("board.nowhere")) throw;
    coverage = guess_board(recording, progress);  // in no image: it may be another one
    coverage.stops.assign(cameras, 0);
    return coverage;
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    coverage.problem = error.what();
    return coverage;
  }
  std::vector<bool> blind(cameras);
  for (std::size_t c = 0; c < cameras; ++c) blind[c] = coverage.stops[c] == 0;
  if (std::find(blind.begin(), blind.end(), true) != blind.end())
    coverage.seen = guessed(recording, blind, boards_of(recording.rig), progress).seen;
  return coverage;
}

BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress) {
  return guessed(recording, {}, {}, progress);
}

}  // namespace rigproof

#include "board_coverage.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/median.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr double kGuessedSquare_m = 0.1;   // which nobody can see
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

constexpr int kOfFurther = 2;  // images that show a board beside another one

bool has_markers(const Board& board) { return board.type != "checkerboard"; }

bool are_one(const Board& a, const Board& b) { return problem_of_telling_apart(a, b).has_value(); }

void interrupt() { throw Error("interrupted", ExitCode::kTryAgain); }

/// @param known boards that are not meant; where there are any, only boards with markers can be told from them
BoardCoverage guessed(const Recording& recording, const std::vector<Board>& known, const CoverageProgress& progress) {
  BoardCoverage coverage;
  BoardGuess guess;
  std::size_t done = 0, total = 0;
  for (const std::vector<CameraFrame>& frames : recording.frames) total += std::min(kGuessedImages, frames.size());
  for (const std::vector<CameraFrame>& frames : recording.frames) {
    std::size_t seen = 0, looked_at = 0;
    const std::size_t count = std::min(kGuessedImages, frames.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (progress && !progress(done++, total)) interrupt();
      const auto image = read_grey_image(path_inside(recording.folder, frames[i * frames.size() / count].color_file));
      if (!std::holds_alternative<Image8>(image)) continue;
      ++looked_at;
      const auto& grey = std::get<Image8>(image);
      const std::optional<Board> board = known.empty() ? any_board(grey) : find_any_marked_board(grey);
      if (!board) continue;
      ++seen;
      guess.add(*board);
    }
    coverage.stops.push_back(seen);
    coverage.looked_at.push_back(looked_at);
  }
  coverage.boards = guess.boards(known);
  for (const Board& board : coverage.boards) coverage.seen.push_back(text_of(board));
  return coverage;
}

std::vector<Board> boards_of(const Rig& rig) {
  std::vector<Board> boards = rig.more_boards;
  boards.insert(boards.begin(), rig.board);
  return boards;
}

bool all_marked(const std::vector<Board>& boards) { return std::all_of(boards.begin(), boards.end(), has_markers); }

}  // namespace

void BoardGuess::add(Board seen) {
  const double marker_m = kGuessedSquare_m * seen.marker_side_m() / seen.square_m;
  seen.square_m = kGuessedSquare_m;
  seen.marker_m.reset();
  Candidate& candidate = candidates_[text_of(seen)];
  candidate.board = seen;
  ++candidate.images;
  ++images_;
  candidate.corners += seen.corner_count();
  candidate.marker_m.push_back(marker_m);
}

std::vector<BoardGuess::Group> BoardGuess::marked_groups(const std::vector<Candidate>& order) {
  std::vector<Group> groups;
  for (const Candidate& one : order) {
    if (!has_markers(one.board)) continue;
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const Group& other) { return are_one(other.board, one.board); });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{one.board});
    group->images += one.images;
    group->corners += one.corners;
  }
  return groups;
}

// By what speaks for them. Ids that are read in several images are no chance, squares without any may be: a floor has
// some.
std::vector<BoardGuess::Group> BoardGuess::groups() const {
  std::vector<Candidate> order;
  for (const auto& [text, candidate] : candidates_) {
    order.push_back(candidate);
    if (has_markers(candidate.board)) order.back().board.marker_m = median(candidate.marker_m);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Candidate& a, const Candidate& b) { return a.corners > b.corners; });
  std::vector<Group> groups = marked_groups(order);
  for (const Candidate& one : order)
    if (!has_markers(one.board)) groups.push_back({one.board, one.images, one.corners});
  const auto is_certain = [](const Group& group) { return has_markers(group.board) && group.images >= kOfFurther; };
  std::stable_sort(groups.begin(), groups.end(), [&](const Group& a, const Group& b) {
    return is_certain(a) != is_certain(b) ? is_certain(a) : a.corners > b.corners;
  });
  return groups;
}

std::vector<Board> BoardGuess::boards(const std::vector<Board>& known) const {
  std::vector<Board> seen, taken = known;
  for (const Group& group : groups()) {
    if (std::any_of(taken.begin(), taken.end(), [&](const Board& other) { return are_one(other, group.board); }))
      continue;
    taken.push_back(group.board);
    if ((known.empty() && seen.empty()) || group.images >= kOfFurther) seen.push_back(group.board);
  }
  return seen;
}

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

BoardCoverage cover_board(const Recording& recording, int threads, const CoverageProgress& progress) {
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
    coverage.stops.assign(cameras, 0);
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    coverage.problem = error.what();
  }
  return coverage;
}

BoardCoverage find_board(const Recording& recording, int threads, const CoverageProgress& progress) {
  BoardCoverage coverage = cover_board(recording, threads, progress);
  if (!coverage.problem.empty()) return coverage;
  const std::vector<Board> known = boards_of(recording.rig);
  const bool any =
      std::any_of(coverage.stops.begin(), coverage.stops.end(), [](std::size_t stops) { return stops > 0; });
  if (any && !all_marked(known)) return coverage;  // a checkerboard may be a part of whatever is there
  BoardCoverage guess = guessed(recording, any ? known : std::vector<Board>(), progress);
  coverage.seen = std::move(guess.seen);
  coverage.boards = std::move(guess.boards);
  return coverage;
}

BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress) {
  return guessed(recording, {}, progress);
}

}  // namespace rigproof

// How often each camera of a recording sees the board.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct BoardCoverage {
  std::vector<std::size_t> stops;      ///< [camera] stops at which the whole board was found
  std::vector<std::size_t> cells;      ///< [camera] of kImageCells, those with a corner in them; empty: a board guessed
  std::vector<std::size_t> looked_at;  ///< [camera] stops that were looked at
  /// The board that most corners speak for, and others beside it that images tell from it, by their markers; their
  /// squares' side means nothing.
  std::vector<Board> boards;
  std::vector<std::string> seen;  ///< the same as rig.yaml says it: "type: checkerboard, squares: [5, 4], ..: 100"
  std::string problem;            ///< why it could not be looked for, and the rest is empty
};

/// Called with images looked at and in all; false interrupts.
using CoverageProgress = std::function<bool(std::uint64_t, std::uint64_t)>;

/// The board in an image, a ChArUco board or a checkerboard of whatever size; its squares' side means nothing.
std::optional<Board> any_board(const Image8& image);

/// Which boards images show; the more of them, the surer.
class BoardGuess {
 public:
  void add(Board seen);
  /// That showed a board.
  int images() const { return images_; }
  /// The one that most corners speak for, boards with markers that are read in several images before others, and
  /// further ones where images tell them apart. Their squares' side means nothing.
  /// @param known boards that are not meant
  std::vector<Board> boards(const std::vector<Board>& known = {}) const;

 private:
  // Alike but for their markers' side, which is read to a hundredth.
  struct Candidate {
    Board board;
    int images = 0;
    int corners = 0;                    // in all of them
    std::vector<double> marker_m = {};  // of each
  };
  // Candidates that images do not tell from one another are one board: a part of it looks like a smaller one with the
  // same markers.
  struct Group {
    Board board;  // the one that most corners speak for
    int images = 0, corners = 0;
  };
  std::vector<Group> groups() const;
  static std::vector<Group> marked_groups(const std::vector<Candidate>& order);

  int images_ = 0;
  std::map<std::string, Candidate> candidates_;
};

/// The boards that the recording's rig states, at every stop.
BoardCoverage cover_board(const Recording& recording, int threads, const CoverageProgress& progress);
/// The same, and other boards in some images of each camera.
BoardCoverage find_board(const Recording& recording, int threads, const CoverageProgress& progress);
/// Any boards, in some images of each camera: which ones they may be.
BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress);

}  // namespace rigproof

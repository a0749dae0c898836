#include "rigproof/core/board_markers.h"

#include <algorithm>
#include <variant>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

using Choice = std::variant<const MarkerDictionary*, std::string>;  // or what is wrong

int marker_count(const Board& board) { return static_cast<int>(markers_of(board).size()); }

const MarkerDictionary* named(const std::string& name) {
  const std::vector<MarkerDictionary>& all = marker_dictionaries();
  const auto found = std::find_if(all.begin(), all.end(), [&name](const auto& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string names() {
  std::string text;
  for (const MarkerDictionary& one : marker_dictionaries()) text += (text.empty() ? "" : ", ") + std::string(one.name);
  return text;
}

std::string too_few(const Board& board, const MarkerDictionary& dictionary) {
  return "[" + std::to_string(board.squares_x) + ", " + std::to_string(board.squares_y) + "] squares need " +
         std::to_string(marker_count(board)) + " markers; " + dictionary.name + " has " +
         std::to_string(dictionary.markers);
}

Choice choose(const Board& board) {
  const MarkerDictionary* chosen = named(board.has_tags() ? "DICT_APRILTAG_36h11" : board.dictionary);
  if (chosen == nullptr && !board.dictionary.empty()) return board.dictionary + ": must be one of " + names();
  if (chosen != nullptr)
    return marker_count(board) <= chosen->markers ? Choice(chosen) : Choice(too_few(board, *chosen));
  for (const char* name : {"DICT_5X5_50", "DICT_5X5_100", "DICT_5X5_250", "DICT_5X5_1000"}) {
    chosen = named(name);
    if (marker_count(board) <= chosen->markers) return chosen;
  }
  return too_few(board, *chosen);
}

// Of dictionaries of one family the smaller are parts of the larger: "DICT_5X5" of DICT_5X5_50.
std::string family_of(const Board& board) {
  const std::string name = dictionary_of(board).name;
  const std::size_t count = name.rfind('_');
  return name.rfind("DICT_APRILTAG", 0) == 0 || name == "DICT_ARUCO_ORIGINAL" ? name : name.substr(0, count);
}

}  // namespace

const std::vector<MarkerDictionary>& marker_dictionaries() {
  static const std::vector<MarkerDictionary> all = {{"DICT_4X4_50", 0, 4, 50},
                                                    {"DICT_4X4_100", 1, 4, 100},
                                                    {"DICT_4X4_250", 2, 4, 250},
                                                    {"DICT_4X4_1000", 3, 4, 1000},
                                                    {"DICT_5X5_50", 4, 5, 50},
                                                    {"DICT_5X5_100", 5, 5, 100},
                                                    {"DICT_5X5_250", 6, 5, 250},
                                                    {"DICT_5X5_1000", 7, 5, 1000},
                                                    {"DICT_6X6_50", 8, 6, 50},
                                                    {"DICT_6X6_100", 9, 6, 100},
                                                    {"DICT_6X6_250", 10, 6, 250},
                                                    {"DICT_6X6_1000", 11, 6, 1000},
                                                    {"DICT_7X7_50", 12, 7, 50},
                                                    {"DICT_7X7_100", 13, 7, 100},
                                                    {"DICT_7X7_250", 14, 7, 250},
                                                    {"DICT_7X7_1000", 15, 7, 1000},
                                                    {"DICT_ARUCO_ORIGINAL", 16, 5, 1024},
                                                    {"DICT_APRILTAG_16h5", 17, 4, 30},
                                                    {"DICT_APRILTAG_25h9", 18, 5, 35},
                                                    {"DICT_APRILTAG_36h10", 19, 6, 2320},
                                                    {"DICT_APRILTAG_36h11", 20, 6, 587}};
  return all;
}

const MarkerDictionary& dictionary_of(const Board& board) {
  const Choice choice = choose(board);
  if (const auto* problem = std::get_if<std::string>(&choice)) throw Error("board.squares: " + *problem);
  return *std::get<const MarkerDictionary*>(choice);
}

std::optional<std::string> problem_of_markers(const Board& board) {
  if (board.type != "charuco" && !board.has_tags()) return std::nullopt;
  const Choice choice = choose(board);
  const auto* problem = std::get_if<std::string>(&choice);
  return problem == nullptr ? std::nullopt : std::optional(*problem);
}

std::optional<std::string> problem_of_telling_apart(const Board& a, const Board& b) {
  if (a.type == "checkerboard" || b.type == "checkerboard")
    return "a plain checkerboard looks like a part of any other board whose markers cannot be read; of several boards "
           "each must be of type charuco or aprilgrid";
  if (family_of(a) != family_of(b)) return std::nullopt;
  return "both have markers of " + family_of(a) + "; make one a charuco board with another dictionary, e.g. " +
         (family_of(a) == "DICT_4X4" ? "DICT_6X6_250" : "DICT_4X4_250");
}

std::vector<BoardMarker> markers_of(const Board& board) {
  std::vector<BoardMarker> markers;
  if (board.has_tags()) {
    for (int iy = board.squares_y - 1; iy >= 0; --iy)
      for (int ix = 0; ix < board.squares_x; ++ix)
        markers.push_back({static_cast<int>(markers.size()), 2 * ix + 1, 2 * iy + 1});
    return markers;
  }
  if (board.type != "charuco") return markers;
  for (int iy = 0; iy < board.squares_y; ++iy)
    for (int ix = 0; ix < board.squares_x; ++ix)
      if (!board.is_dark(ix, iy)) markers.push_back({static_cast<int>(markers.size()), ix, iy});
  return markers;
}

double first_corner_m(const Board& board) {
  return board.has_tags() ? 0.5 * (board.square_m - board.marker_side_m()) : board.square_m;
}

double overhang_m(const Board& board) { return board.has_tags() ? first_corner_m(board) : 0.0; }

}  // namespace rigproof

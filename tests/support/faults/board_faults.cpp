#include <cmath>

#include "recording_faults.h"

namespace rigproof::faults {
namespace {

const std::vector<std::string> kSize = {"board.size", "prior.strained"};
// Beyond what a board can be off by, its size is the second half of the sentence about the depth's unit.
const std::vector<std::string> kSizeOrUnit = {"board.size", "depth.unit_of_all", "depth.unit"};
// A board that is not found is named by its frames.
const std::vector<std::string> kNotFound = {"board.nowhere", "board.never_seen", "camera.no_view", "camera.no_pose"};

RecordingFault board_fault(const std::string& name, const std::vector<std::string>& codes,
                           const std::function<void(Board*)>& edit) {
  return {name, "board", codes, {Files::kRig}, [edit](FaultyRecording* r) {
            r->edit_rig([&](Rig* rig) { edit(&rig->board); });
          }};
}

RecordingFault squares_fault(const std::string& name, int more_x, int more_y) {
  return board_fault(name, kNotFound, [=](Board* board) {
    board->squares_x += more_x;
    board->squares_y += more_y;
  });
}

// The whole drive before a board that is printed or bent otherwise.
RecordingFault print_fault(const std::string& name, const std::string& variant, const std::vector<std::string>& codes) {
  const auto apply = [variant](FaultyRecording* r) {
    for (const auto& frames : r->now().frames)
      for (const CameraFrame& frame : frames) {
        r->replace_by_variant(frame.color_file, variant);
        if (!frame.depth_file.empty()) r->replace_by_variant(frame.depth_file, variant);
      }
  };
  return {name, "board", codes, {Files::kColor, Files::kDepth}, apply, {}, {variant}};
}

}  // namespace

std::vector<RecordingFault> board_faults() {
  std::vector<RecordingFault> faults;
  for (const double percent : {0.2, 0.5, 1.0, 2.0, 3.0, 5.0, -5.0, 10.0, 100.0, 900.0, -90.0})
    faults.push_back(board_fault(sized("squares of the board", percent, " %"),
                                 std::abs(percent) > 50.0 ? kSizeOrUnit : kSize,
                                 [percent](Board* board) { board->square_m *= 1.0 + percent / 100.0; }));
  faults.push_back(board_fault("the board's columns and rows swapped", kNotFound,
                               [](Board* board) { std::swap(board->squares_x, board->squares_y); }));
  faults.push_back(squares_fault("inner corners told as squares", -1, -1));
  faults.push_back(squares_fault("the board told one square too wide and high", 1, 1));
  faults.push_back(squares_fault("the board told two squares too wide", 2, 0));
  faults.push_back(print_fault("the board's squares 0.5 % wider than high", "wide-0.5",
                               {"board.size", "corners.off", "prior.strained"}));
  faults.push_back(print_fault("the board's squares 2 % wider than high", "wide-2",
                               {"board.size", "corners.off", "prior.strained"}));
  faults.push_back(print_fault("the board bent by 1 mm", "bow-1", {"corners.off"}));
  faults.push_back(print_fault("the board bent by 6 mm", "bow-6", {"corners.off"}));
  return faults;
}

}  // namespace rigproof::faults

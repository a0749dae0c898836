#include "depth_check.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "board_depth.h"
#include "rigproof/calib/geometry/depth_unit.h"
#include "rigproof/core/median.h"

namespace rigproof::detection {
namespace {

// Depth over the distance at which the corners put the board, as a logarithm: sensors, boards and lenses that are off
// stay well within.
constexpr double kAgrees = 0.1;
constexpr double kOneFactor = 0.05;  // depth in another unit is off by the same everywhere
// Of the frames that tell.
constexpr double kMost = 0.8, kFew = 0.5;
constexpr std::size_t kLeastFrames = 3;
constexpr std::size_t kLeastPoints = 20;

using Ratios = std::vector<double>;  // ln of measured over expected distance, of the frames that tell

// Where the board is by depth; absent where no points meet it.
std::optional<double> log_ratio(const std::optional<DepthPoints>& points, const Board& board,
                                const std::optional<Rigid3>& T_camera_board) {
  if (!points || !T_camera_board) return std::nullopt;
  const DepthPoints on_board = split_at_board(*points, board, *T_camera_board).on_board;
  if (on_board.points.size() < kLeastPoints) return std::nullopt;
  const Eigen::Vector3d normal = T_camera_board->rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d plane = normal / normal.dot(T_camera_board->translation);
  std::vector<double> shares;
  for (const Eigen::Vector3f& point : on_board.points) shares.push_back(plane.dot(point.cast<double>()));
  return std::log(median(std::move(shares)));
}

const std::optional<Rigid3>& own_pose(const DepthFrame& frame) { return frame.T_camera_board; }

template <typename PoseOf>
Ratios ratios_of(const std::vector<DepthFrame>& frames, DepthReading reading, const Board& board,
                 const PoseOf& pose_of) {
  Ratios ratios;
  for (const DepthFrame& frame : frames)
    if (const std::optional<double> ratio = log_ratio(frame.points(reading), board, pose_of(frame)))
      ratios.push_back(*ratio);
  return ratios;
}

std::size_t agreeing(const Ratios& ratios, double with, double within = kAgrees) {
  return static_cast<std::size_t>(
      std::count_if(ratios.begin(), ratios.end(), [=](double ratio) { return std::abs(ratio - with) < within; }));
}

// Most of the frames see the board where it is.
bool explains(const Ratios& ratios, std::size_t frames) {
  const auto count = static_cast<double>(agreeing(ratios, 0.0));
  return ratios.size() >= kLeastFrames && count >= kMost * static_cast<double>(ratios.size()) &&
         count >= kFew * static_cast<double>(frames);
}

// The largest depth of an image, where a good part of the board lies at it to the millimetre; a sensor that clamps
// what is beyond its range.
std::optional<double> clamped_at(const DepthPoints& points, const Board& board, const Rigid3& T_camera_board) {
  const DepthPoints on_board = split_at_board(points, board, T_camera_board).on_board;
  if (on_board.points.size() < kLeastPoints) return std::nullopt;
  const auto at_most = std::count_if(on_board.points.begin(), on_board.points.end(), [&](const Eigen::Vector3f& point) {
    return std::abs(point.z() - points.farthest_m) < 1e-3;
  });
  if (2 * at_most < static_cast<std::ptrdiff_t>(on_board.points.size())) return std::nullopt;
  return points.farthest_m;
}

std::optional<Finding> clamped(const std::vector<DepthFrame>& frames, const Board& board) {
  std::vector<double> limits;
  std::size_t off = 0;
  for (const DepthFrame& frame : frames) {
    const std::optional<DepthPoints> points = frame.points(DepthReading::kAsItIs);
    const std::optional<double> ratio = log_ratio(points, board, frame.T_camera_board);
    if (!ratio || std::abs(*ratio) < kAgrees) continue;
    ++off;
    if (const auto limit = clamped_at(*points, board, *frame.T_camera_board)) limits.push_back(*limit);
  }
  if (limits.size() < kLeastFrames || static_cast<double>(limits.size()) < kMost * static_cast<double>(off))
    return std::nullopt;
  return Finding("depth.clamped", {{"at_m", median(std::move(limits))}});
}

std::optional<DepthFault> of_another_view(const std::vector<DepthFrame>& frames, const Board& board) {
  for (const auto& [pose, to] : {std::pair(&DepthFrame::T_camera_board_before, "previous"),
                                 std::pair(&DepthFrame::T_camera_board_after, "next")})
    if (explains(ratios_of(frames, DepthReading::kAsItIs, board, [p = pose](const DepthFrame& f) { return f.*p; }),
                 frames.size()))
      return DepthFault{Finding("depth.shifted", {{"to", to}})};
  for (std::size_t other = 0; other < frames.front().T_other_board.size(); ++other)
    if (explains(ratios_of(frames, DepthReading::kAsItIs, board,
                           [other](const DepthFrame& frame) { return frame.T_other_board[other]; }),
                 frames.size()))
      return DepthFault{Finding("depth.of_another_camera"), static_cast<int>(other)};
  return std::nullopt;
}

std::optional<DepthFault> of_another_orientation(const std::vector<DepthFrame>& frames, const Board& board) {
  const auto fits = [&](DepthReading reading) {
    return explains(ratios_of(frames, reading, board, own_pose), frames.size());
  };
  for (const auto& [reading, how] : {std::pair(DepthReading::kMirrored, "mirrored left to right"),
                                     std::pair(DepthReading::kUpsideDown, "mirrored upside down"),
                                     std::pair(DepthReading::kHalfTurn, "turned by half a turn")})
    if (fits(reading)) return DepthFault{Finding("depth.mirrored", {{"how", how}}), -1, reading};
  return std::nullopt;
}

}  // namespace

std::optional<DepthFault> find_depth_fault(const std::vector<DepthFrame>& frames, const Board& board, double unit_m) {
  if (frames.size() < kLeastFrames) return std::nullopt;
  const Ratios as_is = ratios_of(frames, DepthReading::kAsItIs, board, own_pose);
  const double middle = as_is.empty() ? 0.0 : median(as_is);
  const auto tells = static_cast<double>(as_is.size());
  // One factor in all frames: a scale, a unit, or a board of another size.
  const bool one_factor =
      as_is.size() >= kLeastFrames && static_cast<double>(agreeing(as_is, middle, kOneFactor)) >= kMost * tells;
  if (explains(ratios_of(frames, DepthReading::kBodyAxes, board, own_pose), frames.size()))
    return DepthFault{Finding("depth.body_axes")};
  if (as_is.size() < kLeastFrames) return std::nullopt;
  if (const auto cause = clamped(frames, board)) return DepthFault{*cause};
  if (one_factor && std::abs(middle) < kAgrees) return std::nullopt;
  if (one_factor) {
    const double factor = std::exp(middle);
    return DepthFault{Finding(unit_explains(factor, unit_m) ? "depth.unit" : "depth.scale", {{"factor", factor}})};
  }
  if (static_cast<double>(agreeing(as_is, 0.0)) >= kFew * tells) return std::nullopt;
  if (const auto fault = of_another_orientation(frames, board)) return fault;
  if (const auto fault = of_another_view(frames, board)) return fault;
  return DepthFault{
      Finding("depth.contradicts", {{"off", as_is.size() - agreeing(as_is, 0.0)}, {"frames", as_is.size()}})};
}

}  // namespace rigproof::detection

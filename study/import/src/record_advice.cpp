#include "record_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {
namespace {

using detection::PlannedStop;
using Pictures = std::vector<std::vector<std::optional<PictureCheck>>>;

Advice turn_from(const std::vector<PlannedStop>& stops, std::size_t stop, double turn_rad) {
  Advice advice;
  advice.stop = stop;
  advice.here = stop + 1 == stops.size();
  advice.turn_deg = std::round(rad_to_deg(wrap_angle(turn_rad)));
  return advice;
}

// The middle of the widest range of headings at which the camera took no image.
std::optional<double> untried_heading(const std::vector<PlannedStop>& stops, const Pictures& pictures,
                                      std::size_t camera) {
  std::vector<double> tried;
  for (std::size_t i = 0; i < stops.size(); ++i)
    if (pictures[i][camera]) tried.push_back(stops[i].stop.yaw_rad);
  if (tried.empty()) return std::nullopt;
  for (double& heading : tried) heading = wrap_angle(heading);
  std::sort(tried.begin(), tried.end());
  double widest = 0.0, middle = 0.0;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const double next = i + 1 < tried.size() ? tried[i + 1] : tried.front() + 2.0 * kPi;
    if (next - tried[i] <= widest) continue;
    widest = next - tried[i];
    middle = 0.5 * (tried[i] + next);
  }
  return middle;
}

std::vector<Advice> for_blind_cameras(const std::vector<PlannedStop>& stops, const RecordCheck& check) {
  std::vector<Advice> all;
  for (std::size_t camera = 0; camera < check.cameras.size(); ++camera) {
    if (check.cameras[camera].board_stops > 0) continue;
    const std::optional<double> heading = untried_heading(stops, check.pictures, camera);
    if (!heading) continue;
    Advice advice = turn_from(stops, stops.size() - 1, *heading - stops.back().stop.yaw_rad);
    advice.cameras = {check.cameras[camera].name};
    const auto same =
        std::find_if(all.begin(), all.end(), [&](const Advice& other) { return other.turn_deg == advice.turn_deg; });
    if (same == all.end())
      all.push_back(advice);
    else
      same->cameras.push_back(advice.cameras.front());
  }
  return all;
}

// Quarter turns of the board in the image, clockwise, from the direction of its columns.
std::optional<int> quarter_turns(const PictureCheck& picture, const Board& board) {
  if (static_cast<int>(picture.corners.size()) != board.corner_count()) return std::nullopt;
  const Eigen::Vector2d down =
      picture.corners.back() - picture.corners[static_cast<std::size_t>(board.inner_corners_x()) - 1];
  return static_cast<int>(std::lround(std::atan2(-down.x(), down.y()) / (0.5 * kPi)) + 4) % 4;
}

// How each camera is turned about its view: against the way in which most see the board, which hangs somehow.
std::vector<int> rolls(const RecordCheck& check, const Board& board) {
  std::vector<std::map<int, int>> votes(check.cameras.size());
  std::map<int, int> all;
  for (const auto& stop : check.pictures)
    for (std::size_t camera = 0; camera < stop.size(); ++camera)
      if (stop[camera] && stop[camera]->board && stop[camera]->which == 0)
        if (const std::optional<int> quarters = quarter_turns(*stop[camera], board)) ++votes[camera][*quarters];
  const auto most = [](const std::map<int, int>& counts) {
    const auto best = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return best == counts.end() ? 0 : best->first;
  };
  for (const auto& counts : votes)
    if (!counts.empty()) ++all[most(counts)];
  std::vector<int> turned;
  for (const auto& counts : votes) turned.push_back(counts.empty() ? 0 : (most(counts) - most(all) + 4) % 4);
  return turned;
}

struct Third {
  int axis = 0;   // 0: across the image, 1: down
  int index = 0;  // 0, 1, 2
  const char* name() const {
    static constexpr std::array<std::array<const char*, 3>, 2> kNames = {
        {{"left", "middle", "right"}, {"upper", "middle", "lower"}}};
    return kNames[static_cast<std::size_t>(axis)][static_cast<std::size_t>(index)];
  }
};

// Corners in each third of the image along an axis.
std::array<int, 3> in_thirds(const RecordCheck& check, std::size_t camera, const Camera& lens, int axis) {
  std::array<int, 3> counts{};
  const double size = axis == 0 ? lens.width_px : lens.height_px;
  for (const auto& stop : check.pictures)
    if (stop[camera])
      for (const Eigen::Vector2d& corner : stop[camera]->corners)
        ++counts[static_cast<std::size_t>(std::clamp(static_cast<int>(3.0 * (corner[axis] + 0.5) / size), 0, 2))];
  return counts;
}

// Where turns move the board, then where distance does; absent where it was everywhere.
std::optional<Third> emptiest_third(const RecordCheck& check, std::size_t camera, const Camera& lens, int sideways) {
  constexpr int kFewOf = 5;  // of the fullest third
  for (const int axis : {sideways, 1 - sideways}) {
    const std::array<int, 3> counts = in_thirds(check, camera, lens, axis);
    const auto least = std::min_element(counts.begin(), counts.end());
    if (kFewOf * *least < *std::max_element(counts.begin(), counts.end()))
      return Third{axis, static_cast<int>(least - counts.begin())};
  }
  return std::nullopt;
}

std::optional<Advice> for_image_part(const RigCamera& camera, std::size_t index, int roll,
                                     const std::vector<PlannedStop>& stops, const RecordCheck& check) {
  const Camera& lens = camera.camera;
  const int sideways = roll % 2;
  const std::optional<Third> third = emptiest_third(check, index, lens, sideways);
  std::size_t last = stops.size();
  while (last > 0 && !(check.pictures[last - 1][index] && check.pictures[last - 1][index]->board)) --last;
  if (!third || last == 0) return std::nullopt;
  const std::vector<Eigen::Vector2d>& corners = check.pictures[last - 1][index]->corners;
  double middle = 0.0;
  for (const Eigen::Vector2d& corner : corners) middle += corner[sideways] / static_cast<double>(corners.size());
  const double size = sideways == 0 ? lens.width_px : lens.height_px;
  const double f = sideways == 0 ? lens.fx_px : lens.fy_px, c = sideways == 0 ? lens.cx_px : lens.cy_px;
  const double wanted = (2.0 * third->index + 1.0) / 6.0 * size;
  // A turn to the left moves what is seen to the right of an upright image.
  const double sense = roll < 2 ? 1.0 : -1.0;
  const double turn =
      third->axis == sideways ? sense * (std::atan((wanted - c) / f) - std::atan((middle - c) / f)) : 0.0;
  Advice advice = turn_from(stops, last - 1, turn);
  advice.cameras = {camera.name};
  advice.part = third->name();
  return advice;
}

}  // namespace

std::vector<Advice> advice_for(const std::vector<RigCamera>& cameras, const std::vector<PlannedStop>& stops,
                               const RecordCheck& check, const Board& board) {
  std::vector<Advice> all = for_blind_cameras(stops, check);
  const std::vector<int> turned = rolls(check, board);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (check.cameras[i].board_stops > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&check](std::size_t a, std::size_t b) { return check.cameras[a].cells < check.cameras[b].cells; });
  for (const std::size_t i : order)
    if (const std::optional<Advice> advice = for_image_part(cameras[i], i, turned[i], stops, check))
      all.push_back(*advice);
  std::stable_partition(all.begin(), all.end(), [](const Advice& advice) { return advice.here; });
  return all;
}

}  // namespace rigproof

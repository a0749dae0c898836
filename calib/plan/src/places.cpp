// Places that are worth a thought.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "outlook.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof::suggest {
namespace {

// From there, and turned as far to either side as commands in whole degrees may leave it.
bool sees_board_when_rounded(const Outlook& outlook, const Place& place) {
  const double margin_rad = deg_to_rad(1.0);
  std::vector<int> cameras = outlook.foresight.cameras_with_board(place.T_world_robot());
  for (const double turn_rad : {-margin_rad, margin_rad}) {
    if (!outlook.enough(cameras)) return false;
    const std::vector<int> turned =
        outlook.foresight.cameras_with_board(place.T_world_robot() * planar_pose(0.0, 0.0, turn_rad));
    std::vector<int> both;
    std::set_intersection(cameras.begin(), cameras.end(), turned.begin(), turned.end(), std::back_inserter(both));
    cameras = both;
  }
  return outlook.enough(cameras);
}

// Anywhere in the area, with one of the cameras looking about at a board.
Place aimed_place(const Outlook& outlook, const std::vector<std::size_t>& posed, RandomStream* random) {
  const DriveArea& area = outlook.floor.area();
  const double x = random->uniform(area.x_min_m, area.x_max_m), y = random->uniform(area.y_min_m, area.y_max_m);
  const Eigen::Vector3d p = outlook.floor.T_world_first() * Eigen::Vector3d(x, y, 0.0);
  const std::size_t c = posed[random->below(static_cast<std::uint32_t>(posed.size()))];
  const Rigid3& X = outlook.state().T_robot_camera[c];
  const Camera& lens = outlook.used().cameras[c].camera;
  const Eigen::Vector3d axis = X.rotation * Eigen::Vector3d::UnitZ();
  const std::vector<int>& boards = outlook.foresight.boards();
  const std::size_t which = boards.size() > 1 ? random->below(static_cast<std::uint32_t>(boards.size())) : 0;
  const Eigen::Vector3d board = outlook.board_centre(boards[which]);
  const double half_view = std::atan(0.5 * lens.width_px / lens.fx_px);
  const double yaw = std::atan2(board.y() - p.y(), board.x() - p.x()) - std::atan2(axis.y(), axis.x()) +
                     random->uniform(-half_view, half_view);
  return {p.x(), p.y(), wrap_angle(yaw)};
}

// Without a metre of driving.
std::vector<Place> turned_on_the_spot(const Outlook& outlook) {
  constexpr int kHeadings = 72;
  const Place here = outlook.last_place();
  std::vector<Place> places;
  for (int i = 0; i < kHeadings; ++i) {
    const Place place = here.turned_to(here.yaw_rad + 2.0 * kPi * i / kHeadings, outlook.turns_about_m());
    if (outlook.floor.may_stand(place) && sees_board_when_rounded(outlook, place)) places.push_back(place);
  }
  return places;
}

}  // namespace

std::vector<Place> candidates_of(const Outlook& outlook) {
  std::vector<std::size_t> posed;  // cameras that can be aimed
  for (std::size_t c = 0; c < outlook.knowledge.has_pose.size(); ++c)
    if (outlook.knowledge.has_pose[c]) posed.push_back(c);
  std::vector<Place> places = turned_on_the_spot(outlook);
  const std::size_t wanted = places.size() + static_cast<std::size_t>(outlook.options.candidates);
  RandomStream random(outlook.options.seed, "suggested places");
  const int tries = 200 * outlook.options.candidates;
  for (int i = 0; i < tries && places.size() < wanted; ++i) {
    const Place place = aimed_place(outlook, posed, &random);
    if (outlook.floor.may_stand(place) && sees_board_when_rounded(outlook, place)) places.push_back(place);
  }
  return places;
}

}  // namespace rigproof::suggest

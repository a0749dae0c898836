#include "rigproof/calib/rivals.h"

#include <algorithm>
#include <iterator>

namespace rigproof {

bool reads_files(const Method& method) {
  const Method* const readers[] = {&memroc_reference_method(), &joint_memroc_reference_method(),
                                   &robot_autocalib_method(), &sensorx2car_method()};
  return std::find(std::begin(readers), std::end(readers), &method) != std::end(readers);
}

const std::vector<const Method*>& rival_methods() {
  static const std::vector<const Method*> methods = [] {
    std::vector<const Method*> list = {&memroc_reference_method(), &joint_memroc_reference_method(),
                                       &robot_autocalib_method(),  &robot_autocalib_board_method(),
                                       &sensorx2car_method(),      &li_method()};
    for (const Method* method : opencv_hand_eye_methods()) list.push_back(method);
    return list;
  }();
  return methods;
}

}  // namespace rigproof

// Reads pairs of rows of 3x4 matrices, T_world_robot and T_camera_board, and prints ViSP's T_robot_camera, or nothing
// where it finds none.
#include <visp3/vision/vpHandEyeCalibration.h>

#include <cmath>
#include <iomanip>
#include <iostream>
#include <vector>

static bool read(vpHomogeneousMatrix* T) {
  for (unsigned i = 0; i < 12; ++i)
    if (!(std::cin >> (*T)[i / 4][i % 4])) return false;
  return true;
}

int main() {
  std::vector<vpHomogeneousMatrix> boards, robots;
  vpHomogeneousMatrix robot, board, camera;
  while (read(&robot) && read(&board)) {
    robots.push_back(robot);
    boards.push_back(board);
  }
  if (vpHandEyeCalibration::calibrate(boards, robots, camera) != 0) return 0;
  for (unsigned i = 0; i < 12; ++i)
    if (!std::isfinite(camera[i / 4][i % 4])) return 0;
  std::cout << "\nT_robot_camera" << std::setprecision(17);
  for (unsigned i = 0; i < 12; ++i) std::cout << " " << camera[i / 4][i % 4];
  std::cout << "\n";
}

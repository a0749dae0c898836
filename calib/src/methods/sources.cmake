# Board poses, the vertical, the closed-form start, observability, and the MEMROC family.
list(APPEND calib_sources
  src/methods/estimate_view_poses.cpp
  src/methods/initial_guess.cpp
  src/methods/observability.cpp
  src/methods/trajectory_alignment.cpp
  src/methods/view_poses.cpp)

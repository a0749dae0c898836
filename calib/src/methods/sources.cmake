# Board poses, the vertical, the closed-form start, observability, the ground, and the MEMROC family.
find_package(Ceres 2.0 REQUIRED)
find_package(PCL 1.12 REQUIRED COMPONENTS common sample_consensus)
list(APPEND calib_sources
  src/methods/depth_bias.cpp
  src/methods/estimate_view_poses.cpp
  src/methods/ground_plane.cpp
  src/methods/hand_eye_problem.cpp
  src/methods/initial_guess.cpp
  src/methods/memroc.cpp
  src/methods/observability.cpp
  src/methods/partial_covariance.cpp
  src/methods/planes_of_cameras.cpp
  src/methods/registry.cpp
  src/methods/shared_views.cpp
  src/methods/trajectory_alignment.cpp
  src/methods/view_poses.cpp)
list(APPEND calib_private_libraries Ceres::ceres pcl_common pcl_sample_consensus)

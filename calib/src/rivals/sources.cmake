# The methods of other people, and what sees features in images.
find_package(OpenCV 4.5 REQUIRED COMPONENTS core calib3d features2d imgproc dnn)
list(APPEND calib_sources
  src/rivals/directions.cpp
  src/rivals/dnn_features.cpp
  src/rivals/dnn_horizon.cpp
  src/rivals/feature_source.cpp
  src/rivals/ground_source.cpp
  src/rivals/horizon_directions.cpp
  src/rivals/image_files.cpp
  src/rivals/image_findings.cpp
  src/rivals/image_ground.cpp
  src/rivals/image_pairs.cpp
  src/rivals/li.cpp
  src/rivals/memroc_reference.cpp
  src/rivals/memroc_reference_cost.cpp
  src/rivals/onnx_network.cpp
  src/rivals/opencv_hand_eye.cpp
  src/rivals/pattern_bundle.cpp
  src/rivals/pattern_graph.cpp
  src/rivals/reference_cloud_plane.cpp
  src/rivals/relative_pose.cpp
  src/rivals/rival_result.cpp
  src/rivals/rivals.cpp
  src/rivals/robot_autocalib.cpp
  src/rivals/robot_autocalib_board.cpp
  src/rivals/robot_autocalib_features.cpp
  src/rivals/robot_autocalib_result.cpp
  src/rivals/sensorx2car.cpp
  src/rivals/straight_drive.cpp
  src/rivals/turn_axes.cpp
  src/rivals/vertical_lines.cpp)
list(APPEND calib_private_libraries opencv_features2d opencv_dnn)

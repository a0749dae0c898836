# Many views of ChArUco boards.
add_executable(bench_charuco
  ${CMAKE_CURRENT_LIST_DIR}/charuco.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/board_picture.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/charuco_views.cpp)
target_include_directories(bench_charuco PRIVATE
  ${PROJECT_SOURCE_DIR}/tests/calib/detection ${PROJECT_SOURCE_DIR}/calib/vision/src)
target_link_libraries(bench_charuco PRIVATE rigproof::calib)
rigproof_apply_rules(bench_charuco)

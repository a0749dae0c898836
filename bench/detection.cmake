# Plain programs: corner detection against the truth of a generated run, and observing against decoding.
find_package(OpenCV 4.5 REQUIRED COMPONENTS calib3d core imgcodecs imgproc)
find_package(Threads REQUIRED)
add_executable(bench_detection ${CMAKE_CURRENT_LIST_DIR}/detection.cpp)
target_link_libraries(bench_detection PRIVATE rigproof::calib rigproof::truth opencv_calib3d opencv_core)
rigproof_apply_rules(bench_detection)
add_executable(bench_observe ${CMAKE_CURRENT_LIST_DIR}/observe.cpp)
target_link_libraries(bench_observe PRIVATE rigproof::calib opencv_core opencv_imgcodecs Threads::Threads)
rigproof_apply_rules(bench_observe)
# Boards in pictures as others make them.
add_executable(bench_detection_foreign
  ${CMAKE_CURRENT_LIST_DIR}/detection_foreign.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/board_picture.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/foreign_picture.cpp)
target_include_directories(bench_detection_foreign PRIVATE
  ${PROJECT_SOURCE_DIR}/tests/calib/detection ${PROJECT_SOURCE_DIR}/calib/vision/src)
target_link_libraries(bench_detection_foreign PRIVATE rigproof::calib opencv_calib3d opencv_core opencv_imgcodecs opencv_imgproc)
rigproof_apply_rules(bench_detection_foreign)
# The same against mrgingham, which is somebody else's program.
add_executable(bench_detection_mrgingham
  ${CMAKE_CURRENT_LIST_DIR}/detection_mrgingham.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/board_picture.cpp
  ${PROJECT_SOURCE_DIR}/tests/calib/detection/foreign_picture.cpp)
target_include_directories(bench_detection_mrgingham PRIVATE
  ${PROJECT_SOURCE_DIR}/tests/calib/detection ${PROJECT_SOURCE_DIR}/tests/support ${PROJECT_SOURCE_DIR}/calib/vision/src)
target_link_libraries(bench_detection_mrgingham PRIVATE rigproof::calib opencv_calib3d opencv_core opencv_imgcodecs opencv_imgproc)
rigproof_apply_rules(bench_detection_mrgingham)

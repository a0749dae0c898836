# Plain programs: corner detection against the truth of a generated run, and observing against decoding.
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgcodecs)
find_package(Threads REQUIRED)
add_executable(bench_detection ${CMAKE_CURRENT_LIST_DIR}/detection.cpp)
target_link_libraries(bench_detection PRIVATE rigproof::calib rigproof::truth)
rigproof_apply_rules(bench_detection)
add_executable(bench_observe ${CMAKE_CURRENT_LIST_DIR}/observe.cpp)
target_link_libraries(bench_observe PRIVATE rigproof::calib opencv_core opencv_imgcodecs Threads::Threads)
rigproof_apply_rules(bench_observe)

# A plain program: the robot's drive alone, without pictures.
add_executable(bench_drive ${CMAKE_CURRENT_LIST_DIR}/drive.cpp)
target_link_libraries(bench_drive PRIVATE rigproof::generator rigproof::study_workflow)
target_include_directories(bench_drive PRIVATE ${PROJECT_SOURCE_DIR}/generator/src)
rigproof_apply_rules(bench_drive)

# NEES of the estimator on driven odometry, without pictures.
add_executable(bench_driven ${CMAKE_CURRENT_LIST_DIR}/driven.cpp)
target_link_libraries(bench_driven PRIVATE CLI11::CLI11 rigproof::generator rigproof::geometric rigproof::calib rigproof::words)
target_include_directories(bench_driven PRIVATE ${PROJECT_SOURCE_DIR}/generator/src ${PROJECT_SOURCE_DIR}/calib/vision/src
                                                ${PROJECT_SOURCE_DIR}/tests/support)
rigproof_apply_rules(bench_driven)

# A plain program: the robot's drive alone, without pictures.
add_executable(bench_drive ${CMAKE_CURRENT_LIST_DIR}/drive.cpp)
target_link_libraries(bench_drive PRIVATE rigproof::generator)
target_include_directories(bench_drive PRIVATE ${PROJECT_SOURCE_DIR}/generator/src)
rigproof_apply_rules(bench_drive)

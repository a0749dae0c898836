# A plain program: false-alarm and detection rates of `moved`.
add_executable(bench_moved ${CMAKE_CURRENT_LIST_DIR}/moved.cpp ${PROJECT_SOURCE_DIR}/tests/support/stranger.cpp)
target_include_directories(bench_moved PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_moved PRIVATE CLI11::CLI11 rigproof::calib rigproof::geometric)
rigproof_apply_rules(bench_moved)

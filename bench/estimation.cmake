# A plain program that prints the table of docs/estimation.md: RMSE over bound, NEES, refusals, time.
add_executable(bench_estimation ${CMAKE_CURRENT_LIST_DIR}/estimation.cpp)
target_include_directories(bench_estimation PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_estimation PRIVATE rigproof::calib rigproof::geometric)
rigproof_apply_rules(bench_estimation)

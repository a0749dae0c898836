# Plain programs. bench_estimation writes the table of docs/measurements/estimation.md: RMSE over bound, NEES, refusals;
# bench_solve times the estimator.
add_executable(bench_estimation
  ${CMAKE_CURRENT_LIST_DIR}/estimation.cpp
  ${CMAKE_CURRENT_LIST_DIR}/estimation_cells.cpp
  ${CMAKE_CURRENT_LIST_DIR}/estimation_report.cpp)
target_include_directories(bench_estimation PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_estimation PRIVATE CLI11::CLI11 rigproof::calib rigproof::geometric fmt::fmt-header-only)
rigproof_apply_rules(bench_estimation)

rigproof_add_benchmark(solve SOURCES ${CMAKE_CURRENT_LIST_DIR}/solve.cpp LINK rigproof::calib rigproof::geometric)

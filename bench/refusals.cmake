# A plain program (it looks into calib for the bound of a test) that prints the tables of what is refused, and how rightly, of docs/measurements/refusals.md.
add_executable(bench_refusals
  ${CMAKE_CURRENT_LIST_DIR}/refusals.cpp
  ${PROJECT_SOURCE_DIR}/tests/support/broken_runs.cpp)
target_include_directories(bench_refusals PRIVATE ${PROJECT_SOURCE_DIR}/tests/support ${PROJECT_SOURCE_DIR}/calib/diagnose/src)
target_link_libraries(bench_refusals PRIVATE CLI11::CLI11 rigproof::calib rigproof::geometric rigproof::words)
rigproof_apply_rules(bench_refusals)

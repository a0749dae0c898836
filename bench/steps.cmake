# A plain program (it looks into calib for the scores): how far healthy drives look as if something had moved, and how small a
# move is found, for docs/measurements/refusals.md.
add_executable(bench_steps ${CMAKE_CURRENT_LIST_DIR}/steps.cpp)
target_include_directories(bench_steps PRIVATE ${PROJECT_SOURCE_DIR}/tests/support ${PROJECT_SOURCE_DIR}/calib/diagnose/src)
target_link_libraries(bench_steps PRIVATE CLI11::CLI11 rigproof::calib_diagnose rigproof::geometric)
rigproof_apply_rules(bench_steps)

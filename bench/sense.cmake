# A plain program: its runs fork, which Google Benchmark's own process must not.
add_executable(bench_sense ${CMAKE_CURRENT_LIST_DIR}/sense.cpp)
target_link_libraries(bench_sense PRIVATE rigproof::generator rigproof::study_workflow)
rigproof_apply_rules(bench_sense)

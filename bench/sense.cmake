# A plain program: its runs fork, which Google Benchmark's own process must not.
add_executable(bench_sense ${CMAKE_CURRENT_LIST_DIR}/sense.cpp)
target_link_libraries(bench_sense PRIVATE rigproof::generator)
target_include_directories(bench_sense PRIVATE ${PROJECT_SOURCE_DIR}/study/workflow/include)
rigproof_apply_rules(bench_sense)

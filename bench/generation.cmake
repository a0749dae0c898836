# A plain program: its runs fork, which Google Benchmark's own process must not.
add_executable(bench_generation ${CMAKE_CURRENT_LIST_DIR}/generation.cpp ${CMAKE_CURRENT_LIST_DIR}/bare_passes.cpp)
target_link_libraries(bench_generation PRIVATE rigproof::generator rigproof::study_workflow)
target_include_directories(bench_generation PRIVATE ${PROJECT_SOURCE_DIR}/generator/src)
rigproof_apply_rules(bench_generation)

# A plain program: its runs fork, which Google Benchmark's own process must not.
add_executable(bench_frames ${CMAKE_CURRENT_LIST_DIR}/frames.cpp ${CMAKE_CURRENT_LIST_DIR}/bare_passes.cpp)
target_link_libraries(bench_frames PRIVATE rigproof::generator rigproof::png rigproof::study_sweep rigproof::study_workflow)
target_include_directories(bench_frames PRIVATE ${PROJECT_SOURCE_DIR}/generator/src)
rigproof_apply_rules(bench_frames)

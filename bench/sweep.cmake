# A plain program: what the machinery of a sweep costs beside its tasks.
add_executable(bench_sweep ${CMAKE_CURRENT_LIST_DIR}/sweep.cpp)
target_include_directories(bench_sweep PRIVATE ${PROJECT_SOURCE_DIR}/study/sweep/src ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_sweep PRIVATE rigproof::study)
rigproof_apply_rules(bench_sweep)

add_executable(bench_render ${CMAKE_CURRENT_LIST_DIR}/render.cpp ${CMAKE_CURRENT_LIST_DIR}/../tests/sim/render_truth.cpp)
target_include_directories(bench_render PRIVATE ${CMAKE_CURRENT_LIST_DIR}/../tests/sim)
target_link_libraries(bench_render PRIVATE rigproof::sim)
rigproof_apply_rules(bench_render)

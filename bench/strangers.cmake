# A plain program: how true the stated uncertainty is on rendered robots that nobody here built.
add_executable(bench_strangers ${CMAKE_CURRENT_LIST_DIR}/strangers.cpp ${CMAKE_CURRENT_LIST_DIR}/strangers_robots.cpp)
target_link_libraries(bench_strangers PRIVATE CLI11::CLI11 rigproof::generator rigproof::study_sweep rigproof::study_workflow
                      rigproof::calib rigproof::validate)
rigproof_apply_rules(bench_strangers)

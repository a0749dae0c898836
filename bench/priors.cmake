# A plain program: what errors drawn from the priors come to, against the stated uncertainty and its budget.
add_executable(bench_priors
  ${CMAKE_CURRENT_LIST_DIR}/priors.cpp
  ${CMAKE_CURRENT_LIST_DIR}/priors_robots.cpp
  ${PROJECT_SOURCE_DIR}/tests/support/stranger.cpp)
target_include_directories(bench_priors PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_priors PRIVATE CLI11::CLI11 rigproof::calib rigproof::geometric rigproof::validate)
rigproof_apply_rules(bench_priors)

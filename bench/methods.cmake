rigproof_add_benchmark(methods SOURCES ${CMAKE_CURRENT_LIST_DIR}/methods.cpp
  ${PROJECT_SOURCE_DIR}/tests/support/synthetic_drive.cpp LINK rigproof::calib)
target_include_directories(bench_methods PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)

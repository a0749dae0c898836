rigproof_add_benchmark(core SOURCES core.cpp LINK rigproof::core rigproof::truth)
target_include_directories(bench_core PRIVATE ${PROJECT_SOURCE_DIR}/study/workflow/include)

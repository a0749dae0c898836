# Alone: core is measured without the simulator, too, and study is not built then.
rigproof_add_benchmark(core SOURCES core.cpp ${PROJECT_SOURCE_DIR}/study/workflow/src/scratch_folder.cpp LINK rigproof::core rigproof::truth)
target_include_directories(bench_core PRIVATE ${PROJECT_SOURCE_DIR}/study/workflow/include)

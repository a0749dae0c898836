rigproof_add_benchmark(core SOURCES core.cpp LINK rigproof::core rigproof::truth)

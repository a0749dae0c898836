# Reading bags against their decoders alone; it also makes long bags out of short ones.
find_package(PkgConfig REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(ZLIB REQUIRED)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
rigproof_add_benchmark(bags
  SOURCES bags.cpp bags_longer.cpp ${PROJECT_SOURCE_DIR}/tests/support/bag_bytes.cpp
  LINK rigproof::bags PkgConfig::LZ4 PkgConfig::ZSTD SQLite::SQLite3 ZLIB::ZLIB)
target_include_directories(bench_bags PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)

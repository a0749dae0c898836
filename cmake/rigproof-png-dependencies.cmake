# What a consumer of the static library rigproof::png links with.
find_dependency(PkgConfig)
if(NOT TARGET PkgConfig::DEFLATE)
  pkg_check_modules(DEFLATE REQUIRED IMPORTED_TARGET libdeflate)
endif()

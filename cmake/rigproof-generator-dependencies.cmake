find_dependency(PkgConfig)
if(NOT TARGET PkgConfig::ISAL)
  pkg_check_modules(ISAL REQUIRED IMPORTED_TARGET libisal)
endif()

# One way to declare a library, a test and a benchmark, so that every target gets the same rules.

function(rigproof_apply_rules target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow
                         $<$<BOOL:${RIGPROOF_WARNINGS_AS_ERRORS}>:-Werror>)
  # Same arithmetic on every machine: no fused multiply-add that only some of them have.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  if(RIGPROOF_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${RIGPROOF_SANITIZE} -fno-omit-frame-pointer
                           -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${RIGPROOF_SANITIZE})
    # Instrumented, g++ 12 sees uninitialised values where std::variant moves them; there are none, and the other builds
    # keep the warning.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

# rigproof_add_library(calib SOURCES a.cpp .. PUBLIC rigproof::core .. PRIVATE ..)
# makes rigproof_calib with the alias rigproof::calib, its headers under include/, installed as component `calib`.
function(rigproof_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target rigproof_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(rigproof::${name} ALIAS ${target})
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  rigproof_apply_rules(${target})
  install(TARGETS ${target} EXPORT rigproof-${name} DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT rigproof-${name} NAMESPACE rigproof:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rigproof)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# rigproof_add_test(core SOURCES .. LINK .. LABELS unit) makes the GoogleTest program test_core; ctest sees each case.
# Tests with the label `unit` are also run under the sanitizers; without LABELS that is what a test is.
# Tests that draw through Mesa have the label `render`: its drivers keep memory that the leak sanitizer would report.
# FIXTURE names a ctest fixture that its cases need.
function(rigproof_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT;FIXTURE" "SOURCES;LINK;LABELS" ${ARGN})
  set(target test_${name})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} rigproof_test_support GTest::gtest GTest::gmock GTest::gtest_main)
  rigproof_apply_rules(${target})
  # GoogleTest's macros take a third less time to compile this way, and what is tested keeps its own flags.
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(unit_tests ${target})
  endif()
  if(RIGPROOF_SANITIZE)
    rigproof_add_shards(${target} ${name} ${ARG_TIMEOUT} "${ARG_LABELS}" "${ARG_FIXTURE}")
    return()
  endif()
  gtest_discover_tests(${target} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}" FIXTURES_REQUIRED "${ARG_FIXTURE}")
endfunction()

# A sanitized program takes longer to start than most cases to run: there ctest sees a few shards of all cases.
function(rigproof_add_shards target name timeout labels fixture)
  set(shards 4)
  math(EXPR last "${shards} - 1")
  math(EXPR shard_timeout "4 * ${timeout}")
  foreach(shard RANGE ${last})
    add_test(NAME "${name}.shard${shard}" COMMAND ${target} --gtest_brief=1)
    set_tests_properties("${name}.shard${shard}" PROPERTIES
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}" TIMEOUT ${shard_timeout}
      LABELS "${labels}" FIXTURES_REQUIRED "${fixture}")
  endforeach()
endfunction()

# rigproof_add_benchmark(render SOURCES .. LINK ..) makes the Google Benchmark program bench_render.
function(rigproof_add_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(target bench_${name})
  find_package(benchmark REQUIRED)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} benchmark::benchmark)
  rigproof_apply_rules(${target})
endfunction()

function(rigproof_install_package)
  include(CMakePackageConfigHelpers)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rigproof)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/rigproof-config.cmake.in
    ${PROJECT_BINARY_DIR}/rigproof-config.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/rigproof-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/rigproof-config.cmake ${PROJECT_BINARY_DIR}/rigproof-config-version.cmake
          DESTINATION ${package_dir})
endfunction()

# One way to declare a library, a test and a benchmark, so that every target gets the same rules.

function(rigproof_apply_rules target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow
                         $<$<BOOL:${RIGPROOF_WARNINGS_AS_ERRORS}>:-Werror>)
  # Same arithmetic on every machine: no fused multiply-add that only some of them have.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
endfunction()

# What the program consists of runs under the sanitizers; the tests that call it are the objects of the release build,
# which ccache knows, as their flags are alike. Shared libraries keep to their own, instrumented copies of inline
# functions. With eigen_assert and assert, whatever the build type.
function(rigproof_sanitize target)
  if(NOT RIGPROOF_SANITIZE)
    return()
  endif()
  target_compile_options(${target} PRIVATE -fsanitize=${RIGPROOF_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all -O1 -g1 -UNDEBUG -Wno-error)
  # These look at every access to a member, which takes a third of the time to compile; address sees a null or dangling
  # pointer, too.
  if(RIGPROOF_SANITIZE MATCHES "address.*undefined")
    target_compile_options(${target} PRIVATE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
  # Eigen takes malloc as aligned where it is not instrumented: in tests and in Debian's libraries (libceres.a).
  # Instrumented Eigen would not, and one would free what the other allocated.
  target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(${target} PUBLIC -fsanitize=${RIGPROOF_SANITIZE} PRIVATE -Wl,-Bsymbolic-functions)
  # Instrumented, g++ 12 sees uninitialised values where std::variant moves them; there are none, and the other builds
  # keep the warning.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()

# rigproof_precompile(library "POSITION_INDEPENDENT_CODE ON" <vector> ..) makes the object library
# rigproof_precompiled_library, whose precompiled headers targets of the same flags share by
# rigproof_use_precompiled(target library). Parsing the standard library and Eigen is over half of what compiling takes.
# Every file still includes what it uses: `scripts/analyse FILE` reads it without these.
function(rigproof_precompile name position_independent)
  set(target rigproof_precompiled_${name})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/precompiled_${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(${target} OBJECT ${source})
  target_link_libraries(${target} PRIVATE Eigen3::Eigen)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ${position_independent})
  rigproof_apply_rules(${target})
endfunction()

function(rigproof_use_precompiled target name)
  target_precompile_headers(${target} REUSE_FROM rigproof_precompiled_${name})
  # ccache needs to see which header was taken in precompiled.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

# rigproof_add_library(calib_vision COMPONENT calib SOURCES a.cpp .. PUBLIC rigproof::core .. PRIVATE ..)
# makes rigproof_calib_vision with the alias rigproof::calib_vision, its headers under include/, installed as part of
# the component `calib`; without COMPONENT its own name is the component's.
function(rigproof_add_library name)
  cmake_parse_arguments(ARG "" "COMPONENT" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target rigproof_${name})
  add_library(${target} ${ARG_SOURCES})
  add_library(rigproof::${name} ALIAS ${target})
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  rigproof_apply_rules(${target})
  rigproof_sanitize(${target})
  rigproof_use_precompiled(${target} library)
  rigproof_install_library(${name} "${ARG_COMPONENT}")
endfunction()

# rigproof_add_interface(calib LINK rigproof::calib_plan ..): a target of headers or of other targets alone.
function(rigproof_add_interface name)
  cmake_parse_arguments(ARG "" "COMPONENT" "LINK" ${ARGN})
  add_library(rigproof_${name} INTERFACE)
  add_library(rigproof::${name} ALIAS rigproof_${name})
  target_include_directories(rigproof_${name} INTERFACE
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(rigproof_${name} INTERFACE ${ARG_LINK})
  rigproof_install_library(${name} "${ARG_COMPONENT}")
endfunction()

function(rigproof_install_library name component)
  if(NOT component)
    set(component ${name})
  endif()
  set(part development)  # of an installation, and a Debian package: Packages.cmake
  if(component MATCHES "^(sim|generator|study)$")
    set(part simulator)
  endif()
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rigproof)
  set_target_properties(rigproof_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS rigproof_${name} EXPORT rigproof-${component} DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${part})
  if(name STREQUAL component)
    install(EXPORT rigproof-${component} NAMESPACE rigproof:: DESTINATION ${package_dir} COMPONENT ${part})
    # What a consumer of the static library links with.
    install(FILES ${PROJECT_SOURCE_DIR}/cmake/rigproof-${component}-dependencies.cmake DESTINATION ${package_dir}
            COMPONENT ${part} OPTIONAL)
  endif()
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/include)
    install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${part})
  endif()
endfunction()

# rigproof_embed(out.cpp HEADER names.h NAMESPACE a::b TEXTS name file.. TEXTS other file..) makes out.cpp, which defines
# each name that the header declares as the text of its files, one after the other.
function(rigproof_embed output)
  cmake_parse_arguments(ARG "" "HEADER;NAMESPACE" "" ${ARGN})
  set(names "")
  set(all_files "")
  set(definitions "")
  set(name "")
  set(next_is_name FALSE)
  foreach(item IN LISTS ARG_UNPARSED_ARGUMENTS)
    if(item STREQUAL "TEXTS")
      set(next_is_name TRUE)
    elseif(next_is_name)
      set(name ${item})
      list(APPEND names ${name})
      set(next_is_name FALSE)
    else()
      list(APPEND files_${name} ${item})
      list(APPEND all_files ${item})
    endif()
  endforeach()
  foreach(name IN LISTS names)
    list(JOIN files_${name} "," files)
    list(APPEND definitions "-DFILES_${name}=${files}")
  endforeach()
  list(JOIN names "," joined_names)
  set(script ${PROJECT_SOURCE_DIR}/cmake/EmbedTexts.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DHEADER=${ARG_HEADER} -DNAMESPACE=${ARG_NAMESPACE} -DNAMES=${joined_names}
            ${definitions} -P ${script}
    DEPENDS ${all_files} ${script} VERBATIM)
endfunction()

# GoogleTest's macros take a third less time to compile this way, and what is tested keeps its own flags.
function(rigproof_apply_test_rules target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# rigproof_add_test(core SOURCES .. LINK .. LABELS unit) makes the GoogleTest program test_core; ctest sees each case.
# Tests with the label `unit` are also run under the sanitizers; without LABELS that is what a test is.
# Tests that draw through Mesa have the label `render`: its drivers keep memory that the leak sanitizer would report.
# FIXTURE names a ctest fixture that its cases need.
# STATISTICAL: cases whose names end in OverTrials (tests/support/trials.h) have the label `statistical` instead.
function(rigproof_add_test name)
  cmake_parse_arguments(ARG "STATISTICAL" "TIMEOUT;FIXTURE" "SOURCES;LINK;LABELS" ${ARGN})
  set(target test_${name})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} rigproof_test_support GTest::gtest GTest::gmock GTest::gtest_main)
  rigproof_apply_rules(${target})
  rigproof_apply_test_rules(${target})
  rigproof_use_precompiled(${target} test)
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
  set(statistical "*OverTrials*")
  if(ARG_STATISTICAL)
    rigproof_discover_tests(${target} ${name} "${statistical}" statistical)
    rigproof_discover_tests(${target} ${name} "-${statistical}" "${ARG_LABELS}")
  else()
    rigproof_discover_tests(${target} ${name} "*" "${ARG_LABELS}")
  endif()
endfunction()

macro(rigproof_discover_tests target name filter labels)
  gtest_discover_tests(${target} TEST_PREFIX "${name}." TEST_FILTER "${filter}" DISCOVERY_TIMEOUT 60
                       DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${labels}" FIXTURES_REQUIRED "${ARG_FIXTURE}")
endmacro()

# A sanitized program takes longer to start than most cases to run: there ctest sees a few shards of all cases.
function(rigproof_add_shards target name timeout labels fixture)
  set(shards 4)
  math(EXPR last "${shards} - 1")
  math(EXPR shard_timeout "4 * ${timeout}")
  foreach(shard RANGE ${last})
    add_test(NAME "${name}.shard${shard}" COMMAND ${target} --gtest_brief=1)
    set_tests_properties("${name}.shard${shard}" PROPERTIES
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard};RIGPROOF_TRIALS=least" TIMEOUT ${shard_timeout}
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
  target_compile_options(${target} PRIVATE -fPIC)  # as the libraries, whose precompiled headers it takes
  rigproof_use_precompiled(${target} library)
endfunction()

function(rigproof_install_package)
  include(CMakePackageConfigHelpers)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rigproof)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/rigproof-config.cmake.in
    ${PROJECT_BINARY_DIR}/rigproof-config.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/rigproof-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/rigproof-config.cmake ${PROJECT_BINARY_DIR}/rigproof-config-version.cmake
          DESTINATION ${package_dir} COMPONENT development)
endfunction()

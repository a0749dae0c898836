# Debian packages, one for each part of an installation: the program with its data, the libraries that build without
# MuJoCo, those that need it, and the Python package.
set(RIGPROOF_MAINTAINER "Rigproof maintainers <maintainers@example.org>" CACHE STRING "Of the packages")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own
set(CPACK_PACKAGE_CONTACT ${RIGPROOF_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program development simulator)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(same_version "(= ${PROJECT_VERSION})")

# rigproof_package(program rigproof science "one line" "more" DEPENDS ..)
macro(rigproof_package component name section summary description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${description}")
  set(depends ${ARGN})
  list(JOIN depends ", " depends)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES ${PROJECT_BINARY_DIR}/copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz ${PROJECT_BINARY_DIR}/changelog.Debian.gz DESTINATION ${doc}
          COMPONENT ${component})
endmacro()

# What the target's program is made of, written when the package is: it has the time of the package.
function(rigproof_sbom component name target)
  set(sbom ${PROJECT_BINARY_DIR}/${name}/sbom.spdx.json)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/${name})
  install(CODE "execute_process(COMMAND ${PROJECT_SOURCE_DIR}/scripts/sbom ${PROJECT_BINARY_DIR} $<TARGET_FILE:${target}>
                                -o ${sbom} --name ${name} --loads ${ARGN} COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${sbom} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endfunction()

set(calibrates "Rigproof finds the poses of a mobile robot's cameras in its robot frame
from views of a checkerboard and odometry, states their uncertainty, and
proves both on generated data whose truth is known.")
rigproof_package(program rigproof science "calibration of a robot's cameras, with proof" "${calibrates}" libegl1 libgl1)
rigproof_sbom(program rigproof rigproof_app libegl1 libgl1)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri, python3")
rigproof_package(development librigproof-dev libdevel "calibration of a robot's cameras: libraries"
  "${calibrates}\n.\nThis package has the static libraries and headers that need no simulator:\nfind_package(rigproof COMPONENTS calib)."
  libceres-dev libdeflate-dev libeigen3-dev libfastcdr-dev libisal-dev liblz4-dev libopencv-dev libpcl-dev libsqlite3-dev
  libssl-dev libyaml-cpp-dev libzstd-dev pkg-config)
rigproof_package(simulator librigproof-sim-dev libdevel "calibration of a robot's cameras: libraries of the simulator"
  "${calibrates}\n.\nThis package has the static libraries and headers of generator, sweeps and\nreports."
  "librigproof-dev ${same_version}" libmujoco-dev libpugixml-dev)
if(TARGET rigproof_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  rigproof_package(python python3-rigproof python "calibration of a robot's cameras: Python package"
    "${calibrates}\n.\nThis package has the module rigproof for Python 3."
    "rigproof ${same_version}" "python3 (>= 3.${Python3_VERSION_MINOR})" "python3 (<< 3.${next_minor})" python3-numpy)
  rigproof_sbom(python python3-rigproof rigproof_python libegl1 libgl1)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/postinst
      ${PROJECT_SOURCE_DIR}/cmake/debian/prerm)
endif()

# Copyright with the licences of what is part of the report's page, and both changelogs.
set(library ${PROJECT_SOURCE_DIR}/study/report/page/third_party)
file(READ ${PROJECT_SOURCE_DIR}/cmake/debian/copyright copyright)
foreach(name d3 three tslib zrender)
  file(READ ${library}/${name}.LICENSE.txt licence)
  string(APPEND copyright "\n----- ${name}, in the page of a report:\n\n${licence}\n")
endforeach()
file(READ ${library}/echarts.NOTICE.txt notice)
file(WRITE ${PROJECT_BINARY_DIR}/copyright "${copyright}\n----- Apache ECharts, in the page of a report, under the Apache License 2.0:\n\n${notice}")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH where that is set
file(WRITE ${PROJECT_BINARY_DIR}/changelog.Debian "rigproof (${PROJECT_VERSION}) unstable; urgency=medium

  * What has changed is in changelog.gz.

 -- ${RIGPROOF_MAINTAINER}  ${date}
")
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_BINARY_DIR}/changelog COPYONLY)
foreach(name changelog changelog.Debian)
  execute_process(COMMAND gzip -9nc ${PROJECT_BINARY_DIR}/${name} OUTPUT_FILE ${PROJECT_BINARY_DIR}/${name}.gz
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()
include(CPack)

# The checkerboard, its pose, images and clouds from disk, and a recording's observations.
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs calib3d)
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
if(NOT TARGET PkgConfig::DEFLATE)
  pkg_check_modules(DEFLATE REQUIRED IMPORTED_TARGET libdeflate)
endif()
list(APPEND calib_sources
  src/detection/board_depth.cpp
  src/detection/board_fit.cpp
  src/detection/board_search.cpp
  src/detection/checkerboard.cpp
  src/detection/corner_grid.cpp
  src/detection/finding_bytes.cpp
  src/detection/homography.cpp
  src/detection/image_io.cpp
  src/detection/ippe.cpp
  src/detection/observe.cpp
  src/detection/odometry_track.cpp
  src/detection/opencv_seed.cpp
  src/detection/parallel.cpp
  src/detection/png.cpp
  src/detection/pnp.cpp
  src/detection/point_cloud.cpp
  src/detection/saddle_candidates.cpp
  src/detection/saddle_fit.cpp
  src/detection/sight.cpp
  src/detection/smooth_image.cpp
  src/detection/stops.cpp)
list(APPEND calib_private_libraries opencv_core opencv_imgproc opencv_imgcodecs opencv_calib3d PkgConfig::DEFLATE
  Threads::Threads)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/rigproof-calib-dependencies.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rigproof)

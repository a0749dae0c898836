# A plain program: our own writer and reader of PNG against libraries'. Built where libspng-dev is there.
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgcodecs imgproc)
find_package(PkgConfig REQUIRED)
pkg_check_modules(DEFLATE REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(SPNG IMPORTED_TARGET spng)
if(SPNG_FOUND)
  add_executable(bench_png ${CMAKE_CURRENT_LIST_DIR}/png.cpp)
  target_include_directories(bench_png PRIVATE ${PROJECT_SOURCE_DIR}/core/png/src)
  target_link_libraries(bench_png PRIVATE rigproof::png PkgConfig::DEFLATE PkgConfig::SPNG opencv_core opencv_imgcodecs
                        opencv_imgproc)
  rigproof_apply_rules(bench_png)
endif()

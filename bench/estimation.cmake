# Plain programs. bench_estimation writes the table and the pictures of docs/estimation.md: RMSE over bound, NEES,
# refusals; bench_solve times the estimator.
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs)
add_executable(bench_estimation
  ${CMAKE_CURRENT_LIST_DIR}/estimation.cpp
  ${CMAKE_CURRENT_LIST_DIR}/estimation_cells.cpp
  ${CMAKE_CURRENT_LIST_DIR}/estimation_report.cpp
  ${PROJECT_SOURCE_DIR}/study/src/inspect_canvas.cpp)
target_include_directories(bench_estimation PRIVATE ${PROJECT_SOURCE_DIR}/tests/support ${PROJECT_SOURCE_DIR}/study/src)
target_link_libraries(bench_estimation PRIVATE rigproof::calib rigproof::geometric opencv_core opencv_imgproc
                      opencv_imgcodecs)
rigproof_apply_rules(bench_estimation)

rigproof_add_benchmark(solve SOURCES ${CMAKE_CURRENT_LIST_DIR}/solve.cpp LINK rigproof::calib rigproof::geometric)

# A plain program: what calibration says of recordings that are broken in files. It renders them, which needs the simulator.
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgcodecs imgproc)
find_package(Threads REQUIRED)
file(GLOB fault_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/support/faults/*.cpp)
add_executable(bench_faults
  ${CMAKE_CURRENT_LIST_DIR}/faults.cpp
  ${CMAKE_CURRENT_LIST_DIR}/faults_data.cpp
  ${CMAKE_CURRENT_LIST_DIR}/faults_verdict.cpp
  ${fault_sources})
target_include_directories(bench_faults PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
target_link_libraries(bench_faults PRIVATE CLI11::CLI11 rigproof::generator rigproof::study_workflow rigproof::words
                      opencv_core opencv_imgcodecs opencv_imgproc Threads::Threads)
rigproof_apply_rules(bench_faults)

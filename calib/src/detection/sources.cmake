# list(APPEND calib_sources src/detection/...cpp)

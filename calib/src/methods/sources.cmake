# list(APPEND calib_sources src/methods/...cpp)

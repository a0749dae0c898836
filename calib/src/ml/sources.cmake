# list(APPEND calib_sources src/ml/...cpp)

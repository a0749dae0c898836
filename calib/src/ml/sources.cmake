list(APPEND calib_sources
  src/ml/arrow_system.cpp
  src/ml/contradictions.cpp
  src/ml/covariance.cpp
  src/ml/information.cpp
  src/ml/ml.cpp
  src/ml/noise.cpp
  src/ml/problem.cpp
  src/ml/residuals.cpp
  src/ml/robust_views.cpp
  src/ml/shared_ground_error.cpp
  src/ml/solver.cpp
  src/ml/state.cpp)

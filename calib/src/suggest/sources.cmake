# Where to go next.
list(APPEND calib_sources
  src/suggest/floor.cpp
  src/suggest/forecast.cpp
  src/suggest/foresight.cpp
  src/suggest/suggest.cpp
  src/suggest/used_observations.cpp)

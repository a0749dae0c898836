# Gates that need no truth.
list(APPEND calib_sources
  src/accept/accept.cpp
  src/accept/criteria.cpp
  src/accept/held_out.cpp)

# Has a camera shifted?
list(APPEND calib_sources
  src/moved/comparison.cpp
  src/moved/held.cpp
  src/moved/knowledge.cpp
  src/moved/moved.cpp)

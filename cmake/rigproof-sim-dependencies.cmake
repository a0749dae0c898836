# What a program that links the static library rigproof::sim needs to find.
find_dependency(mujoco)
find_dependency(OpenCV COMPONENTS aruco core imgcodecs imgproc)

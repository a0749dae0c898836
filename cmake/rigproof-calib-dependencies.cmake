# What a consumer of the static library rigproof::calib links with.
find_dependency(OpenCV COMPONENTS aruco core imgproc imgcodecs calib3d features2d dnn)
find_dependency(Ceres 2.0)
find_dependency(PCL 1.12 COMPONENTS common sample_consensus)
find_dependency(Threads)

find_dependency(OpenCV COMPONENTS core imgproc imgcodecs)

find_dependency(OpenCV COMPONENTS core features2d imgproc imgcodecs)
find_dependency(pugixml)

// What names of topics tell.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// "/left/image_raw/compressed" -> "/left/image_raw".
std::string without_transport(const std::string& topic);
/// "/left/image_raw/compressed" -> "/left": what image and CameraInfo share.
std::string namespace_of(const std::string& topic);
/// What the last part says of the place beside the words for images and their kinds: "/cams/left_image_rect" -> "left",
/// "/left/image_raw" -> "".
std::string place_in(const std::string& topic);
/// "/a/b" -> {"a", "b"}.
std::vector<std::string> parts_of(const std::string& topic);
/// How many leading parts two topics share.
std::size_t shared_parts(const std::string& a, const std::string& b);
/// Rectified images go with the matrix P of CameraInfo.
bool is_rectified(const std::string& topic);
/// Infrared, disparity, masks and pictures for people: no cameras unless a user names them.
bool is_side_product(const std::string& topic);
/// A name for each camera out of its topic: what the topics do not share, without the words that all cameras have.
std::vector<std::string> camera_names(const std::vector<std::string>& topics);

}  // namespace rigproof

// Images told by the number of their stop, as layouts without time have them.
#pragma once

#include <string>
#include <vector>

#include "rigproof/formats/format.h"

namespace rigproof {

/// "0007": of equal width, so that names sort by number.
std::string stop_number(std::size_t stop);

/// Copies a camera's images to FOLDER/NUMBER.png (or as they end) and counts them in `images`.
/// @param folder below the job's
/// @return one name a stop, relative to the job's folder; empty where the camera has no image
std::vector<std::string> copy_stop_images(const WriteJob& job, std::size_t camera, const std::string& folder,
                                          std::size_t* images);

/// The same of the images in which the board was found alone: one name for each of the observations' board views of
/// the camera, in their order.
std::vector<std::string> copy_board_images(const WriteJob& job, const Observations& observations, std::size_t camera,
                                           const std::string& folder, std::size_t* images);

}  // namespace rigproof

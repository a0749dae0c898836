// Pictures of boards as cameras and simulators of others make them: aliased, sharpened, demosaiced, compressed.
#pragma once

#include <string>
#include <vector>

#include "board_picture.h"

namespace rigproof {

/// What is done to a picture, in this order.
struct ForeignPicture {
  std::string name;
  BoardPictureOptions picture;
  bool demosaiced = false;  ///< Bayer's pattern, edge-aware interpolation
  double sharpened = 0.0;   ///< unsharp mask of one pixel: the share that is added
  int jpeg_quality = 0;     ///< 0 = not compressed
};

/// The kinds that detection is measured on, a clean one first.
std::vector<ForeignPicture> foreign_pictures();

/// A board wholly in the image of a camera of 1280x720 or 640x480, up to 3.5 m away and 55 degrees oblique.
struct ForeignView {
  Camera camera;
  Board board;
  Rigid3 T_camera_board;
};
ForeignView foreign_view(std::uint64_t seed);

/// Grey, of the camera's size.
Image8 draw_foreign(const Camera& camera, const Board& board, const Rigid3& T_camera_board, const ForeignPicture& kind,
                    std::uint64_t seed);

/// Whether OpenCV's findChessboardCornersSB finds the board.
bool opencv_finds(const Image8& grey, const Board& board);

}  // namespace rigproof

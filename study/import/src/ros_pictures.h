// Pictures of ROS messages as files of a recording.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rectifier.h"
#include "rigproof/png/png_encoder.h"

namespace rigproof {

struct PictureKind {
  std::string encoding;  ///< as the message names it; "png", "jpeg", "compressedDepth" of compressed ones, "points"
  bool is_depth = false;
  int width = 0, height = 0;
};
/// Of an Image, CompressedImage or PointCloud2 message, without unpacking it. Throws Error without the topic's name.
PictureKind kind_of_picture(const std::string& type, const std::string& topic, std::string_view message);

/// A file to write.
struct PictureFile {
  std::string extension;  ///< ".png" or ".jpg"
  std::string_view bytes;
  int width = 0, height = 0;
};

/// Makes the files. Colour becomes PNG without loss (16 bits stay 16 bits, raw Bayer patterns are interpolated, alpha
/// is dropped); JPEG and PNG stay as they are. Depth becomes PNG of 16 bits. Throws Error without the topic's name.
class PictureMaker {
 public:
  /// What a message holds; the bytes stay valid until the next call or the end of the message.
  /// @param rectifier what to rectify them by; they then become PNG. Null: not at all
  PictureFile color(const std::string& type, std::string_view message, const Rectifier* rectifier = nullptr);
  /// @param unit_m metres of one count of the file; 16-bit depth of ROS (millimetres, REP 118) is left as it is
  PictureFile depth(const std::string& type, std::string_view message, double unit_m,
                    const Rectifier* rectifier = nullptr);

 private:
  PictureFile rectified_depth(const PictureFile& file, const Rectifier& rectifier);
  PictureFile encoded(const Image8& image);
  PictureFile encoded(const Image16& image);

  PngEncoder encoder_;
  std::string kept_;
};

/// Metres of one count in which depth of an encoding is written: floating-point metres reach 6.5 m, at a tenth of a
/// millimetre; everything else has millimetres.
double depth_unit_m(const std::string& encoding);

/// The largest unit, of 1 mm down to the tenth, that all metres of a 32FC1 image are whole multiples of: that of a
/// device whose counts became metres, which are kept exactly in it. A tenth of a millimetre where there is none;
/// nothing where the image has too few different values to tell, or cannot be read.
std::optional<double> unit_of_metres(std::string_view message);

}  // namespace rigproof

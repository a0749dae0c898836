#include "marker_codes.h"

#include <opencv2/aruco/dictionary.hpp>

namespace rigproof::detection {

std::vector<Eigen::MatrixXf> marker_pictures(const MarkerDictionary& dictionary, int count, int border) {
  const cv::Ptr<cv::aruco::Dictionary> codes = cv::aruco::getPredefinedDictionary(dictionary.number);
  const int bits = dictionary.bits;
  std::vector<Eigen::MatrixXf> pictures;
  for (int id = 0; id < count; ++id) {
    const cv::Mat code = cv::aruco::Dictionary::getBitsFromByteList(codes->bytesList.rowRange(id, id + 1), bits);
    Eigen::MatrixXf picture = Eigen::MatrixXf::Ones(bits + 6, bits + 6);
    picture.block(3 - border, 3 - border, bits + 2 * border, bits + 2 * border).setZero();
    for (int y = 0; y < bits; ++y)
      for (int x = 0; x < bits; ++x) picture(y + 3, x + 3) = code.at<unsigned char>(y, x) == 0 ? 0.0F : 1.0F;
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace rigproof::detection

// Small networks in ONNX, made byte by byte: what a network is must not depend on a file from somewhere.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// Laid out as SuperPoint, one layer deep: bright pixels are keypoints. The input is 1 x 1 x H x W.
std::string keypoint_network(int score_channels = 65);
inline constexpr int kNetworkDescriptors = 16;

/// Input 1 x 3 x 512 x 512. "ahead" is the centre of brightness, the sum of all brightness taken to be that of
/// `white_px` white pixels of 512 x 512; "horizon" is the line of that slope (downwards to the right, in units of the
/// image's half sizes) through it. Outputs that are not wanted are left out.
std::string horizon_network(double white_px, double slope, bool ahead = true, bool horizon = true);

}  // namespace rigproof

// Units in which depth is written.
#pragma once

namespace rigproof {

/// True if depth that is too large by the factor may have been written in another unit that is in use: of images with
/// counts of `unit_m`, or of clouds in metres. Any other factor is an error of scale.
bool unit_explains(double factor, double unit_m);

}  // namespace rigproof

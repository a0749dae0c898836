// What the shape and the look of the scene do to a depth image, before any noise: occlusion, edges, missing texture.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/random.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

/// Takes the depth away where an imager, beside the camera by `offset_m` along x, does not see the point: left of near
/// things for one on the right. The shadow of an edge is focal * offset * (1/z_near - 1/z_far) pixels wide.
/// @param clean what is there; depth_m may already have holes
void remove_hidden(const ImageF& clean, double focal_px, double offset_m, ImageF* depth_m);

/// Edges of the depth image, where 1/z bends by more than the step: planes have none, however oblique.
/// Within two pixels of an edge the pixel shows what is `edge_jitter_px` (one sigma) beside it, and `flying_share` of
/// these pixels lie between that and another pixel of the neighbourhood, evenly in 1/z.
void blur_edges(const ImageF& clean, const DepthSensing& model, RandomStream random, ImageF* depth_m);

/// Takes the depth away in blocks of 8x8 pixels that have too little texture for matching beyond the projector's reach,
/// and in those that are saturated.
void remove_textureless(const Image8& color, const DepthSensing& model, ImageF* depth_m);

/// Moves the image by whole pixels; what comes from outside is 0.
void shift_image(int shift_x, int shift_y, ImageF* depth_m);

}  // namespace rigproof

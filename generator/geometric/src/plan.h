// The plan: a frame whose z axis passes through the board's centre and whose x axis points to the viewers.
#pragma once

#include "rigproof/core/board.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {

Rigid3 board_in_plan(const GeometricRig& rig);
/// True if every corner of the squares lies in the image and the board is not seen too obliquely.
bool sees_board(const RigCamera& camera, const Rigid3& T_camera_board, const Board& board);

}  // namespace rigproof

#pragma once

#include "rigproof/calib/vision/stops.h"

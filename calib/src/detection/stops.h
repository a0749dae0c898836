#pragma once

#include "rigproof/calib/stops.h"

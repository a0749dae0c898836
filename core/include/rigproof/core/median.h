// The middle of many values.
#pragma once

#include <vector>

namespace rigproof {

/// The middle value; of an even number the upper of the two, 0 of none.
double median(std::vector<double> values);

}  // namespace rigproof

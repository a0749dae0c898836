#include "remedies.h"

#include <algorithm>

namespace rigproof {
namespace {

struct Stated {
  const char* source;
  const char* measure;
};
constexpr std::array<Stated, 11> kStated = {{{"board", "squares"},
                                             {"lens", "lens"},
                                             {"print and lens residual", "residual"},
                                             {"depth scale", "scale"},
                                             {"depth error", "offset"},
                                             {"turning point", "centre"},
                                             {"riding height", "height"},
                                             {"places of boards", "places"},
                                             {"clock", "clock"},
                                             {"turn lag", "lag"},
                                             {"rolling shutter", "readout"}}};

}  // namespace

std::optional<std::string> measurement_for(const std::string& source) {
  const auto* const found =
      std::find_if(kStated.begin(), kStated.end(), [&](const Stated& known) { return known.source == source; });
  return found == kStated.end() ? std::nullopt : std::optional<std::string>(found->measure);
}

}  // namespace rigproof

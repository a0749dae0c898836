#include "rigproof/core/version.h"

namespace rigproof {

const char* version() { return RIGPROOF_VERSION; }

}  // namespace rigproof

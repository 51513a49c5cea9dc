#include "controlspace/version.h"

namespace controlspace {

std::string_view version() { return CONTROLSPACE_VERSION; }

}  // namespace controlspace

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "study/study.h"

namespace controlspace {

/// Settings of the command line by key, as they were written.
using GivenSettings = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// Sets what is given in `study` and in all of its runs. Throws InputError that names the option.
void apply(const GivenSettings& settings, Study& study);

}  // namespace controlspace

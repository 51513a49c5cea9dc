// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace controlspace {

/// Something the caller gave cannot be used: a missing or malformed file, a metric that is not
/// positive definite, a source outside the domain, an option out of range.
/// `what()` is one line that names the place and the remedy; the command line prints it and exits
/// with status 2.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace controlspace

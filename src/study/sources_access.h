// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/study/access.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// The value of `sources`: sphere, planes or none, or any number of files and primitives.
Access<Study> sources_access();

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "case_of_each.h"
#include "contract/structures_under_test.h"

// STRUCTURE_CASE(filter, "what holds") { ... structure ... } is a test case for each structure that
// passes the filter: "what holds - K_L", and so on.
#define STRUCTURE_CASE(filter, ...) \
    CASE_OF_EACH(structure, controlspace::structures_that(filter), __VA_ARGS__)

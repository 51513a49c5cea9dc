// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// A continuous source: a field given by a formula or a file, with what its values do not show. The
/// field's domain is where it is defined.
struct AnalyticField {
    std::shared_ptr<const ControlSpace> field;
    double finest_length = 0;  ///< lower bound of its lengths, in any direction
    /// Places in what is small in the field, so that a search for it begins there; may be empty.
    std::vector<Point> places = {};
    bool is_isotropic = false;  ///< known to be, everywhere
};

/// The field whose metric at p is formula(p), for p in `domain`. `formula` is called from several
/// threads at once; `finest_length` is a lower bound of its lengths. Throws InputError for a
/// `finest_length` that is not positive; sampling throws it, with the place, where the formula
/// gives a metric that is not positive definite.
AnalyticField function_field(std::function<Metric(const Point&)> formula, double finest_length,
                             const Box& domain = Box::everywhere());

/// Throws InputError if `domain` extends beyond the field's domain; `name` is for the message.
void require_defined(const AnalyticField& field, const Box& domain, const std::string& name);

}  // namespace controlspace

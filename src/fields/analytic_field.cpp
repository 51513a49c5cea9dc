// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/analytic_field.h"

#include <utility>

#include "controlspace/fields/formula_field.h"
#include "controlspace/sources/point_source.h"
#include "refuse.h"

namespace controlspace {

AnalyticField function_field(std::function<Metric(const Point&)> formula, double finest_length,
                             const Box& domain) {
    require_length("finest length of a field", finest_length);
    auto checked = [formula = std::move(formula)](const Point& p) {
        const Metric m = formula(p);
        if (!is_positive_definite(m)) {
            refuse(
                "the field answers {} (xx yy zz xy xz yz) at ({}, {}, {}), which is not positive "
                "definite: correct its formula or shrink the domain",
                to_string(m), p.x(), p.y(), p.z());
        }
        return m;
    };
    return {formula_field(std::move(checked), domain), finest_length};
}

void require_defined(const AnalyticField& field, const Box& domain, const std::string& name) {
    if (!field.field) return;
    const Box definition = field.field->domain();
    if (definition.contains(domain.low) && definition.contains(domain.high)) return;
    refuse(
        "the field {} is defined in {}, but the domain is {}: give one "
        "that lies within",
        name, to_string(definition), to_string(domain));
}

}  // namespace controlspace

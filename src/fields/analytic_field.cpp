#include "controlspace/fields/analytic_field.h"

#include <fmt/format.h>

#include <utility>

#include "controlspace/error.h"
#include "controlspace/fields/formula_field.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

AnalyticField function_field(std::function<Metric(const Point&)> formula, double finest_length,
                             const Box& definition) {
    if (!is_length(finest_length)) {
        throw InputError(
            fmt::format("finest length {} of a field: give the smallest length that "
                        "it asks for, a positive number",
                        finest_length));
    }
    auto checked = [formula = std::move(formula)](const Point& p) {
        const Metric m = formula(p);
        if (!is_positive_definite(m)) {
            throw InputError(fmt::format(
                "the field answers {} (xx yy zz xy xz yz) at ({}, {}, {}), which is not positive "
                "definite: correct its formula or shrink the domain",
                to_string(m), p.x(), p.y(), p.z()));
        }
        return m;
    };
    return {std::make_shared<FormulaField<decltype(checked)>>(std::move(checked)), definition,
            finest_length};
}

void require_defined(const AnalyticField& field, const Box& domain, const std::string& name) {
    if (field.definition.contains(domain.low) && field.definition.contains(domain.high)) return;
    throw InputError(
        fmt::format("the field {} is defined in {}, but the domain is {}: give one "
                    "that lies within",
                    name, to_string(field.definition), to_string(domain)));
}

}  // namespace controlspace

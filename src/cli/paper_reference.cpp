// SPDX-License-Identifier: Apache-2.0
#include "cli/paper_reference.h"

#include <cmath>

#include "controlspace/fields/surface_fields.h"
#include "controlspace/study/workload.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::shared_ptr<const ControlSpace> make(const Study&, const Case& c, const Workload& workload) {
    const SourcesChoice& s = c.sources;
    const double length = s.h * s.s_a;
    return sphere_field({.radius = s.radius,
                         .lengths = {.across = length,
                                     .along = length,
                                     .growth = 2 * (c.g_r - 1) / (c.g_r + 1),
                                     .largest = workload.domain.half_diagonal()}})
        .field;
}

void require_isotropic_sphere(const SourcesChoice& sources) {
    if (sources.kind != SourcesKind::sphere || has_field(sources)) {
        refuse("reference published-sphere is for the sphere alone: use exact");
    }
    if (sources.centre != Point::Zero()) {
        refuse("reference published-sphere is around the origin: use exact");
    }
    constexpr double rounding = 1e-9;  // such lengths show what round-off decides
    if (std::abs(sources.s_n - 1) > rounding) {
        refuse("reference published-sphere is isotropic: use exact, or s_n = 1");
    }
}

}  // namespace

const ReferenceKind& published_sphere() {
    static const ReferenceKind kind{"published-sphere",
                                    "the analytic field behind the paper's Table 4", make,
                                    require_isotropic_sphere};
    return kind;
}

std::span<const CaseParameter> program_parameters() {
    static const ReferenceKind* const kinds[] = {&exact_reference_kind(), &published_sphere()};
    static const std::vector<CaseParameter> all = case_parameters_with(kinds);
    return all;
}

}  // namespace controlspace

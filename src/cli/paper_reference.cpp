#include "cli/paper_reference.h"

#include "controlspace/error.h"
#include "controlspace/measure/reference.h"
#include "controlspace/study/workload.h"

namespace controlspace {
namespace {

std::shared_ptr<const ControlSpace> make(const Study&, const Case& c, const Workload& workload) {
    const SourcesChoice& s = c.sources;
    return published_sphere_reference(s.radius, s.h * s.s_a, c.g_r,
                                      workload.domain.half_diagonal());
}

void require_isotropic_sphere(const SourcesChoice& sources) {
    if (sources.kind != SourcesKind::sphere || has_field(sources)) {
        throw InputError("reference published-sphere is for the sphere alone: use exact");
    }
    if (sources.centre != Point::Zero()) {
        throw InputError("reference published-sphere is around the origin: use exact");
    }
    if (sources.s_n != 1) {
        throw InputError("reference published-sphere is isotropic: use exact, or s_n = 1");
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

#include "study/case.h"

#include <fmt/format.h>

#include "study/names.h"

namespace controlspace {

bool is_as_published(const Case& c) {
    return c.law == GradationLaw::mean_length && c.schedule == GradationSchedule::passes &&
           c.reference == ReferenceKind::published_sphere;
}

std::string structure_label(const Case& c) {
    return c.split ? fmt::format("{} {}", c.structure, name_of(*c.split)) : c.structure;
}

std::string setting_label(const Case& c) {
    const std::string sampling =
        is_sampled(c.sources)
            ? fmt::format("rho {}, s_a {}, s_n {}, ", c.sources.rho, c.sources.s_a, c.sources.s_n)
            : std::string();
    return fmt::format("{}tau {}, epsilon {}, g_r {}; {} law, {}, {} reference", sampling, c.tau,
                       c.epsilon, c.g_r, name_of(c.law), name_of(c.schedule), name_of(c.reference));
}

}  // namespace controlspace

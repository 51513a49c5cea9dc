#include "study/case.h"

#include <fmt/format.h>

#include "study/names.h"

namespace controlspace {

std::string sources_name(const SourcesChoice& s) {
    switch (s.kind) {
        case SourcesKind::sphere:
            return "sphere";
        case SourcesKind::planes:
            return "planes";
        case SourcesKind::none:
            return "none";
        case SourcesKind::file:
            break;
    }
    return s.file.string();
}

namespace {

std::string variant_of(const Case& c) {
    std::string label;
    if (c.voxel) label += fmt::format(", voxel {:.4g}", *c.voxel);
    if (c.voxel_factor && *c.voxel_factor != SpaceOptions().voxel_factor) {
        label += fmt::format(", c {:.4g}", *c.voxel_factor);
    }
    if (c.prune_delta) label += fmt::format(", pruned at {:.4g}", *c.prune_delta);
    if (c.target_delta) label += fmt::format(", δ <= {:.4g}", *c.target_delta);
    if (c.equal_delta) label += fmt::format(", for delta {:.4g}", *c.equal_delta);
    if (c.equal_memory) label += fmt::format(", for {:.4g} MB", *c.equal_memory);
    if (c.neighbourhood == Neighbourhood::all) label += ", all neighbours";
    if (c.node_values == NodeValues::exact) label += ", exact at nodes";
    if (c.frozen != Frozen::no) label += fmt::format(", frozen with {}", name_of(c.frozen));
    return label;
}

}  // namespace

std::string variant_label(const Case& c) { return c.structure + variant_of(c); }

std::string structure_label(const Case& c) {
    // An adapted tree is cut by no rule.
    const bool by_rule = c.split && !c.target_delta;
    return c.structure + (by_rule ? fmt::format(" {}", name_of(*c.split)) : "") + variant_of(c);
}

namespace {

std::string sources_label(const SourcesChoice& s) {
    std::string sampling;
    if (has_field(s)) sampling = fmt::format("field {}, ", name_of(s.field.kind));
    if (is_sampled(s)) {
        if (s.sampling != Sampling::regular) {
            sampling += fmt::format("{} sources, ", name_of(s.sampling));
        }
        sampling += fmt::format("rho {}, s_a {}, s_n {}, ", s.rho, s.s_a, s.s_n);
    }
    return sampling;
}

}  // namespace

std::string setting_label(const Case& c) {
    return fmt::format("{}tau {}, epsilon {}, g_r {:.6g}; {} law, {}, {} reference",
                       sources_label(c.sources), c.tau, c.epsilon, c.g_r, name_of(c.law),
                       name_of(c.schedule), name_of(c.reference));
}

std::string work_label(const Case& c) {
    return fmt::format("{}g_r {:.6g}; {} law, {} reference", sources_label(c.sources), c.g_r,
                       name_of(c.law), name_of(c.reference));
}

}  // namespace controlspace

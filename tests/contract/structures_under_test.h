#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"

namespace controlspace {

/// A row of the catalogue with one of the split rules that apply to it.
struct Structure {
    const CatalogueEntry* entry;
    SplitRule split;

    std::string name() const {
        static const char* const rules[] = {" s_L", " s_G", " s_M"};
        return entry->id + (entry->has<SplitRules>() ? rules[static_cast<int>(split)] : "");
    }
};

/// All structures with all their split rules; but for those that round, which promise less.
inline std::vector<Structure> all_structures() {
    std::vector<Structure> all;
    for (const CatalogueEntry& entry : structures()) {
        if (is_rounding(entry)) continue;
        all.push_back({&entry, SplitRule::middle});
        if (!entry.has<SplitRules>()) continue;
        all.push_back({&entry, SplitRule::golden});
        all.push_back({&entry, SplitRule::metric});
    }
    return all;
}

/// A sphere small enough to test many structures on it.
struct Work {
    std::string name;
    std::vector<PointSource> sources;
    Box domain{Point(-1, -1, -1), Point(1, 1, 1)};

    SpaceOptions options(SplitRule split) const {
        // Deep enough that no rule is stopped by the depth: s_M peels slab after slab.
        return {.domain = domain,
                .split = split,
                .kd_depth = 200,
                .finest_length = finest_length(sources)};
    }
    std::unique_ptr<EditableSpace> inserted(const Structure& structure) const {
        auto space = editable(structure.entry->make(options(structure.split)));
        space->insert(sources);
        return space;
    }
    std::unique_ptr<EditableSpace> graded(const Structure& structure,
                                          const GradationOptions& gradation = {}) const {
        auto space = inserted(structure);
        space->grade(gradation);
        return space;
    }
};

inline Work isotropic_sphere() {
    return {"isotropic", sample_sphere({.h = 0.05, .s_a = 2, .s_n = 1, .rho = 2})};
}
inline Work anisotropic_sphere() {
    return {"anisotropic", sample_sphere({.h = 0.1, .s_a = 4, .s_n = 0.25, .rho = 2})};
}

}  // namespace controlspace

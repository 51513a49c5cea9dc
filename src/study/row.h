#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "controlspace/gradation/grade.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/space/control_space.h"
#include "measure/access_time.h"
#include "study/case.h"

namespace controlspace {

/// What was measured of one structure.
struct Measures {
    std::uint64_t sources_inserted = 0;  ///< sources that changed the structure
    Footprint footprint;                 ///< after gradation
    double insert_s = 0;                 ///< making the structure and inserting all sources
    double gradation_s = 0;
    GradationReport gradation;
    AccessTime access_random;    ///< at random places
    AccessTime access_grid;      ///< at cell centres, x fastest
    Accuracy accuracy;           ///< δ_R at probe_grid^3 cell centres
    Accuracy accuracy_fine;      ///< δ_R at fine_probe_grid^3 cell centres
    double source_accuracy = 0;  ///< δ_S
};

/// The outcome of one case: measures, or the reason why there are none.
struct Row {
    Case setting;
    std::size_t sources = 0;
    std::optional<Measures> measures;
    std::string error;
};

}  // namespace controlspace

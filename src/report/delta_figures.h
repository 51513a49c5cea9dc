#pragma once

#include <string>
#include <vector>

#include "report/figure.h"
#include "report/sampled_fields.h"
#include "study/text_table.h"

namespace controlspace {

/// How δ to the exact field is distributed over the domain: a histogram for each structure.
Figure delta_histograms(const SampledFields& fields, const std::string& name,
                        const std::string& made_by);

/// The same in numbers, with those that were stored when the rows were measured.
TextTable delta_table(const SampledFields& fields);

/// δ between every two structures, and the exact field: 95th percentile and maximum.
Figure cross_validation(const SampledFields& fields, const std::string& name,
                        const std::string& made_by);

}  // namespace controlspace

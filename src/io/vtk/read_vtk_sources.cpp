// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/read_vtk_sources.h"

#include <fmt/format.h>

#include "io/text/metric_rows.h"
#include "io/vtk/vtk_metrics.h"

namespace controlspace {

std::vector<PointSource> read_vtk_sources(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    const VtkMetrics data = read_vtk_metrics(path, options, "--source-array");
    if (data.hidden > 0 && options.remark) {
        options.remark(fmt::format("{}: {} hidden {} are left out (vtkGhostType)", path.string(),
                                   data.hidden, data.at_points ? "points" : "cells"));
    }
    return sources_from(data.positions, data.metrics);
}

}  // namespace controlspace

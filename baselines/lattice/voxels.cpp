// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/voxels.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "controlspace/geometry/extent.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/input_errors.h"
#include "refuse.h"

namespace controlspace {

namespace {

// Gradation works on a copy of the metrics, with an index and a flag per node in its queue.
constexpr double gradation_bytes_per_node = sizeof(Metric) + sizeof(NodeIndex) + 1;

constexpr double node_limit = 4294967296.0;  // NodeIndex has 32 bits

std::string name_of(const Vector& cells) {
    if ((cells.array() == cells.x()).all()) return fmt::format("{:.0f}^3", cells.x());
    return fmt::format("{:.0f} x {:.0f} x {:.0f}", cells.x(), cells.y(), cells.z());
}

std::string name_of_bytes(double bytes) {
    constexpr std::array units{"B", "kB", "MB", "GB", "TB", "PB"};
    std::size_t unit = 0;
    for (; bytes >= 999.5 && unit + 1 < units.size(); ++unit) bytes /= 1000;
    return fmt::format("{:.3g} {}", bytes, units[unit]);
}

}  // namespace

Vector lattice_nodes(const Box& domain, const Vector& cells, Interpolation interpolation) {
    if (interpolation == Interpolation::nearest) return cells;
    Vector nodes = cells.array() + 1;
    if (const auto flat = flat_axis(domain)) nodes[*flat] = 1;
    return nodes;
}

Vector whole_cells(const Vector& cells) { return (cells.array() * (1 - 1e-12)).ceil().max(1); }

double longest_voxel_edge(const SpaceOptions& options) {
    if (options.voxel > 0) return options.voxel;
    if (!std::isfinite(options.finest_length) || !(options.finest_length > 0)) {
        refuse(
            "a grid cannot size its voxels by a finest length of {}: set SpaceOptions::"
            "voxel, or finest_length to the smallest length that any source requests",
            options.finest_length);
    }
    return options.l_min * options.finest_length;
}

Voxels choose_voxels(const SpaceOptions& options, Interpolation interpolation,
                     const std::function<double(const Vector& nodes)>& bytes_of) {
    require_valid(options);
    const auto bytes_needed = [&](const Vector& cells) {
        const Vector nodes = lattice_nodes(options.domain, cells, interpolation);
        return bytes_of(nodes) + nodes.prod() * gradation_bytes_per_node;
    };
    const auto fits = [&](const Vector& cells) {
        return lattice_nodes(options.domain, cells, interpolation).prod() < node_limit &&
               bytes_needed(cells) <= static_cast<double>(options.max_bytes);
    };

    const Vector edges = options.domain.edges();
    const Vector wanted = whole_cells(edges / longest_voxel_edge(options));
    if (fits(wanted)) return {wanted, ""};

    // Bisection over the number of cells along the longest edge.
    const auto divided = [&](std::uint64_t n) {
        return whole_cells(edges / edges.maxCoeff() * static_cast<double>(n));
    };
    std::uint64_t fitting = 1;
    std::uint64_t too_fine = std::uint64_t{1} << 32;
    if (!fits(divided(fitting))) {
        throw MemoryLimitError(
            static_cast<std::size_t>(bytes_needed(divided(fitting))),
            fmt::format("a memory cap of {} holds no cell of a grid, which takes {}: "
                        "raise the cap",
                        name_of_bytes(static_cast<double>(options.max_bytes)),
                        name_of_bytes(bytes_needed(divided(fitting)))));
    }
    while (too_fine - fitting > 1) {
        const std::uint64_t middle = fitting + (too_fine - fitting) / 2;
        (fits(divided(middle)) ? fitting : too_fine) = middle;
    }
    const Vector cells = divided(fitting);
    return {cells, fmt::format("{}; {} would need {}", name_of(cells), name_of(wanted),
                               name_of_bytes(bytes_needed(wanted)))};
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <atomic>
#include <cstdint>

#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// What a vertex holds: its number, in the order of insertion, and what is blended.
struct TetVertex {
    static constexpr NodeIndex none = ~NodeIndex{};
    NodeIndex index = none;
    Metric value;
};

/// What adaptation notes: the place, by its number, where the tetrahedron misses the goal most.
struct TetState {
    static constexpr std::uint32_t unknown = ~std::uint32_t{}, settled = unknown - 1;
    std::uint32_t worst = unknown;
};

using TetKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Delaunay = CGAL::Delaunay_triangulation_3<
    TetKernel, CGAL::Triangulation_data_structure_3<
                   CGAL::Triangulation_vertex_base_with_info_3<TetVertex, TetKernel>,
                   CGAL::Triangulation_cell_base_with_info_3<
                       TetState, TetKernel, CGAL::Delaunay_triangulation_cell_base_3<TetKernel>>>>;

/// Where the last search ended, at which the next begins. A copy belongs to another triangulation:
/// it remembers nothing.
class LastCell {
public:
    LastCell() = default;
    LastCell(const LastCell&) {}
    LastCell& operator=(const LastCell&) {
        forget();
        return *this;
    }
    Delaunay::Cell_handle get() const { return cell_.load(std::memory_order_relaxed); }
    void set(Delaunay::Cell_handle cell) { cell_.store(cell, std::memory_order_relaxed); }
    void forget() { set({}); }

private:
    std::atomic<Delaunay::Cell_handle> cell_ = Delaunay::Cell_handle();
};

}  // namespace controlspace

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baselines/openvdb/level_cells.h"
#include "baselines/openvdb/level_values.h"
#include "controlspace/gradation/node_graph.h"

namespace controlspace {

/// The control nodes of a stack of levels, numbered: finest level first, within a level in the
/// order of the tree. They are the centres of the active cells, or the vertices of these, each
/// place once. Holds as long as the levels' cells do not change; works on all of TBB's threads,
/// with the same result whatever their number.
class LevelNodes {
public:
    /// Both must outlive the numbering.
    LevelNodes(const LevelCells& cells, std::span<const VdbLevelTree> trees,
               Interpolation interpolation);

    std::size_t size() const { return size_; }
    std::vector<Metric> metrics() const;
    /// Writes the metrics of all nodes into `trees`, those that this was made from.
    void assign(std::span<const Metric> metrics, std::span<VdbLevelTree> trees) const;
    NodeGraph graph(Neighbourhood neighbourhood) const;
    std::vector<Point> positions() const;

private:
    using Coord = openvdb::Coord;
    /// Numbers of the nodes of a level; off, and `none`, where there is none.
    using NumberTree = openvdb::tree::Tree4<std::int32_t, 3, 3, 2>::Type;
    static constexpr std::int32_t none = -1;
    using NumberReader = LevelAccess<const NumberTree>;

    void number(int level);
    NodeGraph graph_of_cells(Neighbourhood neighbourhood) const;
    NodeGraph graph_of_nearest() const;
    NodeGraph graph_of_vertices(Neighbourhood neighbourhood) const;
    template <class Trees, class Visit>
    void for_each_node(int level, const Trees& trees, Visit&& visit) const;
    template <class Links>
    std::vector<std::pair<NodeIndex, NodeIndex>> pairs(Links&& links) const;
    static std::pair<NodeIndex, int> node_at(const NumberReader& numbers, const Coord& finest,
                                             int likely);
    void enter_pair(std::vector<std::pair<NodeIndex, NodeIndex>>& pairs,
                    const NumberReader& numbers, int level, const Coord& c,
                    const Coord& neighbour) const;
    NodeIndex nearest_across(const NumberReader& numbers, int level, const Coord& c,
                             int face) const;

    const LevelCells& cells_;
    std::span<const VdbLevelTree> trees_;
    Interpolation interpolation_;
    std::vector<NumberTree> numbers_;
    std::size_t size_ = 0;
};

}  // namespace controlspace

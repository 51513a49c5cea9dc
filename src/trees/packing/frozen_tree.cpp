#include "trees/packing/frozen_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/trees/detail/packed_tree.h"
#include "trees/packing/frozen_values.h"

namespace controlspace {

namespace {

// Throws InputError if `rounded` is too far from `m`.
void require_close(const Metric& rounded, const Metric& m) {
    constexpr double most = 1e-6;  // a length is off by 0.1 %
    const bool in_range =
        std::min({rounded.xx, rounded.yy, rounded.zz}) > std::numeric_limits<float>::min() &&
        is_positive_definite(rounded);
    if (in_range && nonconformity(rounded, m) < most) return;
    throw InputError(
        fmt::format("floats cannot hold the metric {} (xx yy zz xy xz yz) to 0.1 % of each "
                    "length: use doubles",
                    to_string(m)));
}

}  // namespace

template <class M>
std::vector<M> stored_metrics(std::span<const Metric> metrics, std::span<const NodeIndex> numbers) {
    std::vector<M> result;
    result.reserve(numbers.size());
    for (const NodeIndex i : numbers) result.emplace_back(metrics[i]);
    if constexpr (std::is_same_v<M, StoredMetric<float>> ||
                  std::is_same_v<M, StoredLength<float>>) {
        // In a loop of its own: GCC 12 takes what is rounded and widened at once for unrounded.
        for (std::size_t k = 0; k < result.size(); ++k) {
            require_close(result[k], metrics[numbers[k]]);
        }
    }
    return result;
}

template std::vector<StoredMetric<float>> stored_metrics(std::span<const Metric>,
                                                         std::span<const NodeIndex>);
template std::vector<StoredMetric<double>> stored_metrics(std::span<const Metric>,
                                                          std::span<const NodeIndex>);
template std::vector<StoredLength<float>> stored_metrics(std::span<const Metric>,
                                                         std::span<const NodeIndex>);
template std::vector<StoredLength<double>> stored_metrics(std::span<const Metric>,
                                                          std::span<const NodeIndex>);

namespace {

// pack(Plane()) for the type of numbers of planes.
template <class Pack>
auto with_plane(const CutPlanes& planes, Pack&& pack) {
    return planes.most() <= std::size_t{1} << 16 ? pack(std::uint16_t()) : pack(std::uint32_t());
}

template <class Node, class Values>
std::unique_ptr<ControlSpace> frozen(Topology<Node> tree, Values values) {
    return std::make_unique<PackedTree<Node, Values>>(std::move(tree), std::move(values));
}

}  // namespace

template <class Node>
std::unique_ptr<ControlSpace> freeze_quadratic(const Topology<Node>& tree,
                                               std::span<const Metric> metrics,
                                               const QuadraticRule& rule, Precision precision) {
    std::vector<LeafIndex> order;
    Topology<Node> ordered = tree.depth_first(order);
    CutPlanes planes(ordered);
    return with_stored<true>(precision, metrics, [&]<class M>(std::type_identity<M>) {
        return with_plane(planes, [&]<class Plane>(Plane) {
            FrozenQuadratic<M, Plane> values(ordered, std::move(planes),
                                             stored_metrics<M>(metrics, order), rule);
            return frozen(std::move(ordered), std::move(values));
        });
    });
}

template <class Node>
std::unique_ptr<ControlSpace> freeze_vertices(const Topology<Node>& tree,
                                              std::span<const Corners> corners,
                                              std::span<const Metric> metrics,
                                              Precision precision) {
    std::vector<LeafIndex> leaves;
    Topology<Node> ordered = tree.depth_first(leaves);
    // Vertices in the order in which the leaves come to them.
    constexpr NodeIndex unknown = ~NodeIndex{0};
    std::vector<NodeIndex> new_number(metrics.size(), unknown);
    std::vector<NodeIndex> vertices;
    std::vector<Corners> ordered_corners;
    vertices.reserve(metrics.size());
    ordered_corners.reserve(leaves.size());
    for (const LeafIndex leaf : leaves) {
        Corners renumbered = corners[leaf];
        for (NodeIndex& vertex : renumbered) {
            NodeIndex& number = new_number[vertex];
            if (number == unknown) {
                number = static_cast<NodeIndex>(vertices.size());
                vertices.push_back(vertex);
            }
            vertex = number;
        }
        ordered_corners.push_back(renumbered);
    }
    CutPlanes planes(ordered);
    return with_stored<true>(precision, metrics, [&]<class M>(std::type_identity<M>) {
        return with_plane(planes, [&]<class Plane>(Plane) {
            FrozenVertices<M, Plane> values(ordered, std::move(planes), ordered_corners,
                                            stored_metrics<M>(metrics, vertices));
            return frozen(std::move(ordered), std::move(values));
        });
    });
}

#define CONTROLSPACE_FREEZE(Node)                                                         \
    template std::unique_ptr<ControlSpace> freeze_quadratic(                              \
        const Topology<Node>&, std::span<const Metric>, const QuadraticRule&, Precision); \
    template std::unique_ptr<ControlSpace> freeze_vertices(                               \
        const Topology<Node>&, std::span<const Corners>, std::span<const Metric>, Precision);
CONTROLSPACE_FREEZE(KdNode)
CONTROLSPACE_FREEZE(OctreeNode)
#undef CONTROLSPACE_FREEZE

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include <openvdb/Types.h>

#include <utility>

#include "baselines/lattice/grid_space.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/vec3s_value.h"

namespace controlspace {

namespace {

using openvdb::Vec3s;
using Vec3sTree = openvdb::tree::Tree4<Vec3s, 5, 4, 3>::Type;

class Vec3sPair {
public:
    using Stored = Metric;

    explicit Vec3sPair(const std::shared_ptr<const LatticeData>& data)
        : diagonals_(diagonal(largest_metric(data->options()))), off_diagonals_(Vec3s(0)) {
        const auto& field = data->field();
        fill_densely(diagonals_, data->lattice(), [&](auto n) { return diagonal(field[n]); });
        fill_densely(off_diagonals_, data->lattice(),
                     [&](auto n) { return off_diagonal(field[n]); });
    }

    static double bytes_for(const Vector& nodes) { return 2 * dense_bytes<Vec3sTree>(nodes); }

    static Metric stored(const Metric& m) { return in_floats(m); }

    class Reader {
    public:
        using Nodes = TreeReader<Vec3sTree>;
        using Leaf = Vec3sTree::LeafNodeType;
        using Leaves = std::pair<const Leaf*, const Leaf*>;

        explicit Reader(const Vec3sPair& pair)
            : diagonals_(pair.diagonals_), off_diagonals_(pair.off_diagonals_) {}

        Metric operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
            return metric_of(diagonals_(i, j, k), off_diagonals_(i, j, k));
        }
        Leaves prepare(const Cell& cell) const {
            return {diagonals_.prepare(cell), off_diagonals_.prepare(cell)};
        }
        template <std::size_t corners, bool ahead = true>
        auto find(const Cell& cell, const Leaves& leaves) const {
            return std::pair(diagonals_.find<corners, ahead>(cell, leaves.first),
                             off_diagonals_.find<corners, ahead>(cell, leaves.second));
        }
        Metric metric(const auto& at, std::size_t corner) const {
            return metric_of(*at.first[corner], *at.second[corner]);
        }

    private:
        Nodes diagonals_, off_diagonals_;
    };
    Reader reader() const { return Reader(*this); }

    void add_to(Footprint& footprint) const {
        add_dense_bytes(diagonals_, footprint);
        add_dense_bytes(off_diagonals_, footprint);
    }

private:
    Vec3sTree diagonals_;
    Vec3sTree off_diagonals_;
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options) {
    return make_grid<OwnPrecision<Vec3sPair>, Interpolation::trilinear>(options);
}

}  // namespace controlspace

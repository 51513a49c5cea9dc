#include "baselines/openvdb/openvdb_vec3s.h"

#include <openvdb/Types.h>
#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/lattice/lattice_space.h"
#include "controlspace/error.h"

namespace controlspace {

namespace {

using openvdb::Vec3s;
using Vec3sTree = openvdb::tree::Tree4<Vec3s, 5, 4, 3>::Type;

Vec3s diagonal(const Metric& m) {
    return {static_cast<float>(m.xx), static_cast<float>(m.yy), static_cast<float>(m.zz)};
}
Vec3s off_diagonal(const Metric& m) {
    return {static_cast<float>(m.xy), static_cast<float>(m.xz), static_cast<float>(m.yz)};
}

template <class Tree>
struct Access {
    openvdb::tree::ValueAccessor<Tree, false> diagonals, off_diagonals;

    Metric operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        const Vec3s& a = diagonals.getValue(voxel(i, j, k));
        const Vec3s& b = off_diagonals.getValue(voxel(i, j, k));
        return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
    }
};

class Vec3sPair {
public:
    Vec3sPair(const Lattice& lattice, const Metric& initial)
        : diagonals_(diagonal(initial)), off_diagonals_(off_diagonal(initial)) {
        fill_densely(diagonals_, lattice, diagonal(initial));
        fill_densely(off_diagonals_, lattice, off_diagonal(initial));
    }

    static double bytes_for(const Vector& nodes) { return 2 * dense_bytes<Vec3sTree>(nodes); }

    auto reader() const { return Access<const Vec3sTree>{{diagonals_}, {off_diagonals_}}; }

    auto writer() {
        struct Writer {
            Access<Vec3sTree> nodes;
            Metric get(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
                return nodes(i, j, k);
            }
            void set(std::uint32_t i, std::uint32_t j, std::uint32_t k, const Metric& m) {
                nodes.diagonals.setValueOnly(voxel(i, j, k), diagonal(m));
                nodes.off_diagonals.setValueOnly(voxel(i, j, k), off_diagonal(m));
            }
        };
        return Writer{{{diagonals_}, {off_diagonals_}}};
    }

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
    if (options.takes_later_sources) {
        throw InputError("a grid of floats takes no later sources: use one of doubles");
    }
    return std::make_unique<SharedBuilder<LatticeSpace<Vec3sPair, TrilinearStencil>>>(options);
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/brick_octree.h"
#include "baselines/openvdb/brick_pool.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/index_reader.h"
#include "baselines/openvdb/octree_file.h"
#include "baselines/openvdb/octree_form.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "refuse.h"
#include "space/plain_cursor.h"
#include "space/shared_builder.h"
#include "trees/topology/leaf_vertices.h"

namespace controlspace {

namespace {

/// A pool of an octree's bricks, stored as `M`, and a tree of OpenVDB that refers to them: a voxel
/// is the finest brick, larger ones are tiles. A cell is a leaf of the octree.
template <class M, class Tree>
class VdbBricks final : public OctreeForm<BrickOctree> {
    using Base = OctreeForm<BrickOctree>;
    using Pool = BrickPool<M>;
    using Value = typename Pool::Value;
    static constexpr bool are_lengths = Pool::are_lengths;

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbBricks(const std::shared_ptr<const BrickOctree>& octree, const Bricks& bricks,
              bool is_only_read)
        : Base(octree, bricks.boxes.voxels, bricks.cuts, is_only_read),
          pool_(*octree, bricks),
          cells_(octree->octants().leaves()),
          control_nodes_(octree->saved() ? leaf_vertices(octree->octants()).positions.size()
                                         : octree->metrics().size()) {
        Base::require_room(bytes_for<Tree>(bricks.boxes) + pool_.bytes_to_come(), *octree);
        if (pool_.units() >> BrickRef::unit_bits != 0) fail_too_many_leaves();
        set_scales(bricks);
        controlspace::fill(tree_, bricks.boxes,
                           [&](LeafIndex brick) { return pool_.ref(brick, bricks.level[brick]); });
        reader_ = IndexReader<Tree>(tree_);
        pool_.fill(*octree, bricks);
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        answer(x, [&](std::size_t i, const Value& value) { out[i] = value; });
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            answer(x, [&](std::size_t i, const Value& value) { out[i] = value.h; });
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return value_at(x); }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return value_at(x).h;
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        // Between floats or doubles a length takes no longer than what remembering a brick saves.
        constexpr bool is_plain = are_lengths && !Pool::are_codes;
        return std::make_unique<std::conditional_t<is_plain, PlainCursor<VdbBricks>, BrickCursor>>(
            *this);
    }

    Footprint footprint() const override {
        Footprint footprint = Base::footprint_of(tree_);
        footprint.cells = cells_;
        footprint.control_nodes = control_nodes_;
        footprint.bytes_topology = tree_.memUsage();
        footprint.bytes_payload = pool_.bytes_payload();
        footprint.bytes_auxiliary += pool_.bytes_auxiliary();
        return footprint;
    }
    std::string vdb_file(StateWriter state) const override {
        if constexpr (are_lengths) {
            const Octants octants = Base::cuts().octants(this->domain());
            return bricks_file(std::move(state), octants, floats_of_vertices(Bricks(octants)));
        } else {
            refuse("tensors are not saved to a .vdb: name a .ctrl");
        }
    }

private:
    // Of the bricks of each level, along an axis: where they begin, of the bits of a voxel's
    // number; and cells a voxel.
    struct Scales {
        std::array<std::int32_t, 1U << BrickRef::level_bits> begin{};
        std::array<double, 1U << BrickRef::level_bits> cells{};
    };
    void set_scales(const Bricks& bricks) {
        Cell voxels = bricks.boxes.voxels;
        for (int level = 0; level <= std::ranges::max(bricks.level); ++level) {
            const auto axes = long_axes(this->domain(), level);
            for (std::size_t a = 0; a < 3; ++a) {
                const auto l = static_cast<std::size_t>(level);
                scales_[a].begin[l] = -voxels[a];
                scales_[a].cells[l] = static_cast<double>(pool_.lattice().cells()[a]) / voxels[a];
                if (axes[a] && voxels[a] > 1) voxels[a] /= 2;
            }
        }
    }

    // The vertices of the octree. Where bricks meet, each rounds by codes of its own: what the last
    // brick has, depth first.
    ControlNodes nodes_of(const Octants& octants, Neighbourhood neighbourhood) const override {
        LeafVertices vertices = leaf_vertices(octants);
        std::vector<Metric> metrics(vertices.positions.size());
        const Bricks bricks(octants);
        const std::span<const VoxelBox> boxes = bricks.boxes.leaves;
        for (std::size_t brick = 0; brick < boxes.size(); ++brick) {
            const BrickRef ref = ref_at(boxes[brick].low);
            const auto enter = [&](LeafIndex leaf, const Cell& low, const Cell& edges) {
                for (std::size_t c = 0; c < 8; ++c) {
                    Cell at = low;
                    for (std::size_t a = 0; a < 3; ++a) at[a] += (c >> a & 1) != 0 ? edges[a] : 0;
                    metrics[vertices.of_leaves[leaf][c]] =
                        pool_.vertex(ref, pool_.lattice().number(at));
                }
            };
            for_each_leaf_of_brick(octants, bricks.parts[brick], {}, pool_.lattice().cells(),
                                   enter);
        }
        return {vertex_graph(vertices.of_leaves, std::move(vertices.positions), neighbourhood),
                std::move(metrics)};
    }
    // Of all vertices, brick by brick. Throws InputError for what is beyond floats.
    std::vector<float> floats_of_vertices(const Bricks& bricks) const {
        std::vector<Metric> metrics;
        metrics.reserve(bricks.parts.size() * pool_.lattice().vertices());
        for (const VoxelBox& box : bricks.boxes.leaves) {
            const BrickRef ref = ref_at(box.low);
            for (std::uint32_t vertex = 0; vertex < pool_.lattice().vertices(); ++vertex) {
                metrics.push_back(pool_.vertex(ref, vertex));
            }
        }
        return lengths_in_floats(metrics);
    }
    // Bricks in place of metrics.
    void save_field(const Octants& octants, StateWriter& state) const override {
        const SavedBricks saved = pool_.saved(Bricks(octants).parts.size());
        SavedBricks::exchange(saved, state);
    }

    [[gnu::always_inline]] BrickRef ref_at(const Cell& voxel) const {
        return {reader_(voxel[0], voxel[1], voxel[2])};
    }

    // Along an axis, from the low face of a brick; 1 is reached but for rounding. Comparisons with
    // the last cell would be mispredicted too often.
    struct Along {
        std::int32_t cell;
        double t;
    };
    [[gnu::always_inline]] static Along along(double in_cells, double below_end) {
        const double from_low = in_cells > 0 ? in_cells : 0;
        const double within = from_low < below_end ? from_low : below_end;
        const auto cell = static_cast<std::int32_t>(within);
        return {cell, within - cell};
    }
    // A brick: its low corner in voxels, and its cells a voxel.
    struct Entered {
        BrickRef ref;
        const std::byte* brick;
        std::array<double, 3> low, cells;
    };
    [[gnu::always_inline]] Entered entered(const Cell& voxel) const {
        Entered at{ref_at(voxel), nullptr, {}, {}};
        at.brick = pool_.brick_of(at.ref);
        for (std::size_t a = 0; a < 3; ++a) {
            at.low[a] = voxel[a] & scales_[a].begin[at.ref.level()];
            at.cells[a] = scales_[a].cells[at.ref.level()];
        }
        return at;
    }
    [[gnu::always_inline]] Value value_in(const Entered& at,
                                          const std::array<double, 3>& in_voxels) const {
        const BrickLattice& lattice = pool_.lattice();
        std::uint32_t vertex = 0;
        std::array<double, 3> t;
        for (std::size_t a = 0; a < 3; ++a) {
            const double in_cells = (in_voxels[a] - at.low[a]) * at.cells[a];
            const Along in = along(in_cells, lattice.below_end(a));
            vertex += static_cast<std::uint32_t>(in.cell) * lattice.step(a);
            t[a] = in.t;
        }
        return pool_.value_in(at.ref, at.brick, vertex, t[0], t[1], t[2]);
    }
    [[gnu::always_inline]] std::array<double, 3> in_voxels(const Point& x) const {
        const VoxelOfPlace& voxel_of = Base::voxel_of();
        return {voxel_of.in_voxels(x.x(), 0), voxel_of.in_voxels(x.y(), 1),
                voxel_of.in_voxels(x.z(), 2)};
    }
    Value value_at(const Point& x) const {
        return value_in(entered(Base::voxel_of()(x)), in_voxels(x));
    }

    /// For one caller: remembers the brick that was entered last, which holds most of the next
    /// places of a walk. Near its faces, where rounding decides who answers, it enters anew. Where
    /// fewer than three of four places are in it, it works without for a while.
    class BrickCursor final : public Cursor {
    public:
        explicit BrickCursor(const VdbBricks& space) : space_(space) {}

        Metric metric_at(const Point& x) override { return value_at(x); }
        double length_at(const Point& x) override {
            if constexpr (are_lengths) {
                return value_at(x).h;
            } else {
                return Cursor::length_at(x);
            }
        }

    private:
        [[gnu::always_inline]] Value value_at(const Point& x) {
            if (without_ > 0) return without(x);
            ++asked_;
            const std::array<double, 3> t = space_.in_voxels(x);
            unsigned within = 1;  // without a branch for each face
            for (std::size_t a = 0; a < 3; ++a) {
                within &= static_cast<unsigned>(t[a] > above_[a]);
                within &= static_cast<unsigned>(t[a] < below_[a]);
            }
            if (within == 0) return enter(x);
            return space_.value_in(at_, t);
        }
        // Not inlined: otherwise what they need is also done for places in the brick.
        [[gnu::noinline]] Value without(const Point& x) {
            --without_;
            return space_.value_at(x);
        }
        [[gnu::noinline]] Value enter(const Point& x) {
            if (++entered_ == most_entered) {
                if (asked_ < few_asked) without_ = long_without;
                asked_ = entered_ = 0;
            }
            const VoxelOfPlace& voxel_of = space_.voxel_of();
            const Entered at = space_.entered(voxel_of(x));
            for (std::size_t a = 0; a < 3; ++a) {
                // On faces of the domain nobody else answers.
                constexpr double infinity = std::numeric_limits<double>::infinity();
                const double high = at.low[a] - space_.scales_[a].begin[at.ref.level()];
                const double near = voxel_of.near(a);
                above_[a] = at.low[a] > 0 ? at.low[a] + near : -infinity;
                below_[a] = high < voxel_of.voxels()[a] ? high - near : infinity;
            }
            at_ = at;
            return space_.value_in(at, space_.in_voxels(x));
        }

        const VdbBricks& space_;
        // Places between these are in the brick.
        std::array<double, 3> above_{}, below_{};
        Entered at_{};
        static constexpr std::uint32_t most_entered = 32, few_asked = 128, long_without = 1024;
        std::uint32_t asked_ = 0, entered_ = 0, without_ = 0;
    };

    // put(i, value) for all places, some at a time: references first, then where places are in
    // their bricks, while these are on their way.
    template <class Put>
    void answer(std::span<const Point> x, const Put& put) const {
        CellBatch in_voxels;
        PlacesInBricks places;
        for (std::size_t first = 0; first < x.size(); first += CellBatch::most) {
            const std::size_t count = std::min(CellBatch::most, x.size() - first);
            locate(x.subspan(first, count), in_voxels, places);
            pool_.answer(places, count,
                         [&](std::size_t i, const Value& value) { put(first + i, value); });
        }
    }
    void locate(std::span<const Point> x, CellBatch& in_voxels, PlacesInBricks& places) const {
        const std::size_t count = x.size();
        Base::voxel_of().locate(x, in_voxels);
        PlacesInBricks::Each<std::uint32_t> bits_of_refs;
        reader_.read(in_voxels, count, bits_of_refs);
        for (std::size_t i = 0; i < count; ++i) {
            const BrickRef ref = places.ref[i] = {bits_of_refs[i]};
            places.brick[i] = pool_.brick_of(ref);
            Pool::prefetch(places.brick[i]);
        }
        places.vertex.fill(0);
        for (std::size_t a = 0; a < 3; ++a) {
            const Scales& scale = scales_[a];
            const double below_end = pool_.lattice().below_end(a);
            const std::uint32_t step = pool_.lattice().step(a);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t level = places.ref[i].level();
                const std::int32_t low = in_voxels.cell[a][i] & scale.begin[level];
                const double in_cells = (in_voxels.t[a][i] - low) * scale.cells[level];
                const Along in = along(in_cells, below_end);
                places.vertex[i] += static_cast<std::uint32_t>(in.cell) * step;
                places.t[a][i] = in.t;
            }
        }
    }

    Pool pool_;
    std::size_t cells_, control_nodes_;
    Tree tree_{0};
    std::array<Scales, 3> scales_;
    IndexReader<Tree> reader_{tree_};
};

/// make(std::type_identity<M>()) for the type that metrics are stored in.
template <class Make>
auto with_brick_type(Precision precision, bool are_lengths, const Make& make) {
    const std::array<Metric, 1> example{are_lengths ? Metric::isotropic(1)
                                                    : Metric{1, 2, 3, 0, 0, 0}};
    return with_stored<true>(precision, example, [&]<class M>(std::type_identity<M>) {
        return make(std::type_identity<OrMetric<M>>());
    });
}

}  // namespace

void BrickOctree::load(const StateReader& state) {
    if (!state.has("bricks.pool")) return Base::load(state);
    is_finished_ = true;
    topology_ = load_topology<OctreeNode>(domain(), state);
    SavedBricks::exchange(saved_.emplace(), state);
    Precision precision{};
    state("compact.precision", precision, Precision::log8);
    state.require(saved_->are_lengths || precision <= Precision::floats, "bricks.are_lengths",
                  "contradicts its precision");
    const std::size_t bricks = Bricks(topology_).parts.size();
    with_brick_type(precision, saved_->are_lengths, [&]<class M>(std::type_identity<M>) {
        state.require(BrickPool<M>::is_sound(*saved_, bricks, domain()), "bricks.pool",
                      "does not fit its tree, or holds what are no metrics");
    });
}

std::unique_ptr<ControlSpace> BrickOctree::finished(
    const std::shared_ptr<const BrickOctree>& octree, std::optional<Precision> precision) {
    const Bricks bricks(octree->octants());
    const auto made = [&](auto stored) -> std::unique_ptr<ControlSpace> {
        using M = typename decltype(stored)::type;
        const auto in_tree = [&](auto type) {
            using Tree = typename decltype(type)::type;
            return std::make_unique<VdbBricks<M, Tree>>(octree, bricks, precision.has_value());
        };
        using Small = typename openvdb::tree::Tree3<std::uint32_t, 2, 3>::Type;
        using Medium = typename openvdb::tree::Tree4<std::uint32_t, 3, 3, 3>::Type;
        const std::int32_t voxels = std::ranges::max(bricks.boxes.voxels);
        if (voxels <= 32) return in_tree(std::type_identity<Small>());
        if (voxels <= 512) return in_tree(std::type_identity<Medium>());
        return in_tree(std::type_identity<VdbTree543<std::uint32_t>>());
    };
    if (octree->saved()) return with_brick_type(*precision, octree->saved()->are_lengths, made);
    return with_stored<true>(
        precision.value_or(Precision::doubles), octree->metrics(),
        [&]<class M>(std::type_identity<M>) { return made(std::type_identity<OrMetric<M>>()); });
}

std::unique_ptr<ControlSpaceBuilder> make_openvdb_bricks(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<BrickOctree>>(options);
}

}  // namespace controlspace

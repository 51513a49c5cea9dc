// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/brick_codes.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/index_reader.h"
#include "baselines/openvdb/octree_voxels.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "controlspace/space/detail/plain_cursor.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/adjacency.h"
#include "controlspace/trees/detail/metric_tree.h"
#include "trees/topology/leaf_vertices.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

namespace {

constexpr int levels_of_brick = 2;

/// K_oV's tree, its leaves cut together as bricks.
class BrickOctree : public MetricTree<OctreeNode, VertexValues> {
    using Base = MetricTree<OctreeNode, VertexValues>;

public:
    explicit BrickOctree(const SpaceOptions& options) : Base(options) {
        brick_levels_ = levels_of_brick;
        deepest_ = 16 + levels_of_brick;  // of bricks, as that of leaves in openvdb-tiles
    }

    const Octants& octants() const { return topology_; }
    const VertexValues& values() const { return storage_; }
    std::span<const Metric> metrics() const { return storage_.metrics().field(); }
    /// Of a form that is only read, which is kept as it was loaded.
    const std::optional<SavedBricks>& saved() const { return saved_; }

    void load(const StateReader& state);
    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const BrickOctree>& octree,
                                                  std::optional<Precision> precision);

private:
    std::optional<SavedBricks> saved_;
};

/// The vertices of a brick: those of 4^3 cells, or of 4^2 on a plane, z fastest.
class BrickLattice {
public:
    static constexpr int most = 4;  // cells along an axis
    static constexpr std::size_t most_vertices = std::size_t{most + 1} * (most + 1) * (most + 1);

    explicit BrickLattice(const Box& domain) {
        std::uint32_t vertices = 1;
        for (std::size_t a = 3; a-- > 0;) {
            const auto axis = static_cast<Axis>(a);
            cells_[a] = domain.low[axis] < domain.high[axis] ? most : 0;
            step_[a] = cells_[a] > 0 ? vertices : 0;
            vertices *= static_cast<std::uint32_t>(cells_[a] + 1);
            below_end_[a] = std::nextafter(cells_[a], 0.0);
        }
        vertices_ = vertices;
    }
    std::size_t vertices() const { return vertices_; }
    const Cell& cells() const { return cells_; }
    std::uint32_t step(std::size_t axis) const { return step_[axis]; }
    /// The largest number below that of the cells along an axis, or 0.
    double below_end(std::size_t axis) const { return below_end_[axis]; }
    /// From the low corner of a cell to the others.
    std::array<std::uint32_t, 8> to_corners() const {
        std::array<std::uint32_t, 8> steps{};
        for (std::size_t c = 0; c < 8; ++c) {
            for (std::size_t a = 0; a < 3; ++a) steps[c] += (c >> a & 1) != 0 ? step_[a] : 0;
        }
        return steps;
    }
    /// Of a vertex.
    std::uint32_t number(const Cell& at) const {
        std::uint32_t number = 0;
        for (std::size_t a = 0; a < 3; ++a) number += static_cast<std::uint32_t>(at[a]) * step_[a];
        return number;
    }

private:
    Cell cells_;  // along each axis
    std::array<double, 3> below_end_;
    std::array<std::uint32_t, 3> step_;
    std::uint32_t vertices_;
};

/// Calls visit(leaf, low, edges) for the leaves of a brick: its low corner and its edges in
/// quarters of the brick's.
template <class Visit>
void for_each_leaf_of_brick(const Octants& tree, Ref ref, const Cell& low, const Cell& edges,
                            const Visit& visit) {
    if (ref.is_leaf()) return visit(LeafIndex{ref.index()}, low, edges);
    const OctreeNode& node = tree.node(ref);
    for (int c = 0; c < node.count(); ++c) {
        const std::size_t slot = node.slot(c);
        Cell child_low = low, child_edges = edges;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!node.cuts(a)) continue;
            child_edges[a] /= 2;
            if ((slot >> a & 1) != 0) child_low[a] += child_edges[a];
        }
        for_each_leaf_of_brick(tree, node.children[slot], child_low, child_edges, visit);
    }
}

/// The bricks of an octree, depth first.
struct Bricks {
    int levels;              // of each below it
    Cuts cuts;               // of the octree
    VoxelBoxes boxes;        // voxels of the size of the finest brick
    std::vector<Ref> parts;  // of the octree
    std::vector<int> level;  // of these

    explicit Bricks(const Octants& tree) : Bricks(tree, tree.levels_below()) {}

private:
    Bricks(const Octants& tree, const std::vector<std::uint8_t>& below)
        : levels(below.empty() ? 0 : std::min<int>(levels_of_brick, below.front())),
          cuts(tree, levels),
          boxes(cuts.bricks(tree.domain())) {
        parts.reserve(boxes.leaves.size());
        list(tree, below, tree.root(), 0);
    }
    void list(const Octants& tree, const std::vector<std::uint8_t>& below, Ref ref, int at) {
        if (!ref.is_leaf() && below[ref.index()] > levels) {
            const OctreeNode& node = tree.node(ref);
            for (int c = 0; c < node.count(); ++c) {
                list(tree, below, node.children[node.slot(c)], at + 1);
            }
            return;
        }
        parts.push_back(ref);
        level.push_back(at);
    }
};

/// A value between those of the eight corners of a cell, at the fractions of its edges.
[[gnu::always_inline]] inline double trilinear(const auto& at, double x, double y, double z) {
    const auto along_z = [&](std::size_t c) { return (1 - z) * at(c) + z * at(c + 4); };
    const double low = (1 - y) * along_z(0) + y * along_z(2);
    const double high = (1 - y) * along_z(1) + y * along_z(3);
    return (1 - x) * low + x * high;
}

/// What a tree of bricks holds: where a brick is in the pool, in units; its kind; its level.
struct BrickRef {
    static constexpr std::uint32_t level_bits = 5, kind_bits = 2;
    static constexpr std::uint32_t unit_bits = 32 - level_bits - kind_bits;

    std::uint32_t bits = 0;

    std::size_t unit() const { return bits >> (level_bits + kind_bits); }
    std::uint8_t kind() const {
        return static_cast<std::uint8_t>(bits >> level_bits & ((1U << kind_bits) - 1));
    }
    std::size_t level() const { return bits & ((1U << level_bits) - 1); }
    static std::uint32_t of(std::size_t unit, std::uint8_t kind, int level) {
        return (static_cast<std::uint32_t>(unit) << kind_bits | kind) << level_bits |
               static_cast<std::uint32_t>(level);
    }
};

/// The vertices of an octree's bricks, stored as `M` in one pool, and a tree of OpenVDB that refers
/// to them.
template <class M, class Tree>
class VdbBricks final : public ControlSpace, public HasControlNodes, public Saved {
    static constexpr bool are_lengths = is_stored_length<M>;
    using Codes = BrickCodes<M>;
    struct alignas(64) Line {
        std::array<std::byte, 64> bytes;
    };

public:
    /// A form that is only read, or one that keeps the octree for what comes later.
    VdbBricks(const std::shared_ptr<const BrickOctree>& octree, const Bricks& bricks,
              bool is_only_read)
        : voxel_of_(octree->domain(), bricks.boxes.voxels),
          lattice_(octree->domain()),
          codes_(octree->saved() ? Codes(octree->saved()->range) : Codes(octree->metrics())),
          cuts_(bricks.cuts),
          cells_(octree->octants().leaves()),
          control_nodes_(octree->metrics().size()),
          kinds_(octree->saved() ? octree->saved()->kinds : kinds_of(*octree, bricks)) {
        const std::vector<std::size_t> first = first_units();
        require_room(bricks, first.back(), octree->options().max_bytes);
        pool_.resize(first.back() * unit_ / sizeof(Line) + 1, Line{});  // LinearCodes::pair_at
        set_scales(bricks);
        fill(tree_, bricks.boxes, [&](LeafIndex brick) {
            return BrickRef::of(first[brick], kinds_[brick], bricks.level[brick]);
        });
        reader_ = IndexReader<Tree>(tree_);
        if (const auto& saved = octree->saved()) {
            std::memcpy(pool_.data(), saved->pool.data(), saved->pool.size());
            control_nodes_ = leaf_vertices(octree->octants()).positions.size();
        } else {
            for_each_brick(*octree, bricks, [&](std::size_t brick, std::span<const Metric> at) {
                codes_.write(kinds_[brick], at,
                             reinterpret_cast<std::byte*>(pool_.data()) + first[brick] * unit_);
            });
        }
        if constexpr (!Codes::are_codes) kinds_ = {};
        if (!is_only_read) octree_ = octree;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        answer(x, [&](std::size_t i, const auto& value) { out[i] = value; });
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            answer(x, [&](std::size_t i, const StoredLength<double>& value) { out[i] = value.h; });
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
        return std::make_unique<PlainCursor<VdbBricks>>(*this);
    }
    Box domain() const override { return voxel_of_.domain(); }

    /// A cell, which is a leaf of the octree.
    std::optional<Box> cell_at(const Point& x) const override {
        if (octree_) return octree_->cell_at(x);
        return cuts_.leaf_at(nearest_in(domain(), x), domain());
    }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.tree_nodes = tree_.leafCount() + tree_.nonLeafCount();
        footprint.cells = cells_;
        footprint.control_nodes = control_nodes_;
        footprint.depth = Tree::DEPTH - 1;
        footprint.bytes_topology = tree_.memUsage();
        footprint.bytes_payload = pool_.capacity() * sizeof(Line) + Codes::table_bytes();
        footprint.bytes_auxiliary = cuts_.bytes() + kinds_.capacity();
        if (octree_) footprint.bytes_auxiliary += octree_->footprint().bytes_total();
        if (given()) footprint.bytes_auxiliary += given()->bytes();
        if (tree_.root().getTableSize() > 1) {
            footprint.remark = fmt::format("{} upper nodes, which a query finds by the root",
                                           tree_.root().getTableSize());
        }
        return footprint;
    }
    /// The vertices of the octree. Where bricks meet, each rounds by codes of its own: what the
    /// last brick has, depth first.
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        if (octree_) return octree_->control_nodes(neighbourhood);
        const Octants octants = cuts_.octants(domain());
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
                    metrics[vertices.of_leaves[leaf][c]] = vertex(ref, lattice_.number(at));
                }
            };
            for_each_leaf_of_brick(octants, bricks.parts[brick], {}, lattice_.cells(), enter);
        }
        return {vertex_graph(vertices.of_leaves, std::move(vertices.positions), neighbourhood),
                std::move(metrics)};
    }
    /// As the octree is saved; a form that is only read with its bricks in place of metrics.
    void save(StateWriter& state) const override {
        if (octree_) return octree_->save(state);
        const Octants octants = cuts_.octants(domain());
        controlspace::save(octants, state);
        const auto* first = reinterpret_cast<const std::uint8_t*>(pool_.data());
        SavedBricks saved{are_lengths, {}, kinds_, codes_.range()};
        if constexpr (!Codes::are_codes) saved.kinds.resize(Bricks(octants).parts.size());
        const std::size_t units = first_units(lattice_, saved.kinds).back();
        saved.pool.assign(first, first + units * unit_);
        SavedBricks::exchange(std::as_const(saved), state);
    }
    /// Whether what was loaded, of so many bricks, can be read.
    static bool is_sound(const SavedBricks& saved, std::size_t bricks, const Box& domain) {
        if (saved.kinds.size() != bricks || saved.are_lengths != are_lengths) return false;
        if (std::ranges::max(saved.kinds) >= Codes::kinds) return false;
        if constexpr (Codes::are_codes) {
            using Limits = std::numeric_limits<float>;
            if (saved.range.size() != 2) return false;
            const double shortest = saved.range[0], longest = saved.range[1];
            if (!(shortest >= Limits::min() && shortest <= longest &&
                  longest < Limits::max() / 2)) {
                return false;
            }
        }
        const BrickLattice lattice(domain);
        const std::vector<std::size_t> first = first_units(lattice, saved.kinds);
        const std::size_t unit = Codes::unit(lattice.vertices());
        if (saved.pool.size() != first.back() * unit) return false;
        const Codes codes(saved.range);
        for (std::size_t brick = 0; brick < bricks; ++brick) {
            const auto* bytes =
                reinterpret_cast<const std::byte*>(&saved.pool[first[brick] * unit]);
            if (!codes.is_sound(saved.kinds[brick], bytes, lattice.vertices())) return false;
        }
        return true;
    }

private:
    // Of the bricks of each level, along an axis: where they begin, of the bits of a voxel's
    // number; and cells a voxel.
    struct Scales {
        std::array<std::int32_t, 1U << BrickRef::level_bits> begin{};
        std::array<double, 1U << BrickRef::level_bits> cells{};
    };

    // Where bricks begin in the pool, in units, and where the last one ends.
    static std::vector<std::size_t> first_units(const BrickLattice& lattice,
                                                std::span<const std::uint8_t> kinds) {
        const std::size_t vertices = lattice.vertices(), unit = Codes::unit(vertices);
        std::vector<std::size_t> first{0};
        first.reserve(kinds.size() + 1);
        for (const std::uint8_t kind : kinds) {
            first.push_back(first.back() + Codes::bytes_of(kind, vertices) / unit);
        }
        return first;
    }
    std::vector<std::size_t> first_units() const { return first_units(lattice_, kinds_); }

    void require_room(const Bricks& bricks, std::size_t units, std::size_t most) const {
        const double bytes =
            bytes_for<Tree>(bricks.boxes) + static_cast<double>(units) * static_cast<double>(unit_);
        if (bytes > static_cast<double>(most)) {
            fail_too_large(static_cast<std::size_t>(bytes), most);
        }
        if (units >> BrickRef::unit_bits != 0) fail_too_many_leaves();
    }
    void set_scales(const Bricks& bricks) {
        Cell voxels = bricks.boxes.voxels;
        for (int level = 0; level <= std::ranges::max(bricks.level); ++level) {
            const auto axes = long_axes(domain(), level);
            for (std::size_t a = 0; a < 3; ++a) {
                const auto l = static_cast<std::size_t>(level);
                scales_[a].begin[l] = -voxels[a];
                scales_[a].cells[l] = static_cast<double>(lattice_.cells()[a]) / voxels[a];
                if (axes[a] && voxels[a] > 1) voxels[a] /= 2;
            }
        }
    }

    // visit(brick, metrics) with the metrics of its vertices: those of the octree's, and what is
    // between them where it has fewer leaves than cells.
    template <class Visit>
    void for_each_brick(const BrickOctree& octree, const Bricks& bricks, const Visit& visit) const {
        const std::span<const Metric> metrics = octree.metrics();
        tbb::parallel_for(std::size_t{0}, bricks.parts.size(), [&](std::size_t brick) {
            std::array<Metric, BrickLattice::most_vertices> vertices;
            const auto enter = [&](LeafIndex leaf, const Cell& low, const Cell& edges) {
                const Corners& corners = octree.values().nodes_of(leaf);
                Cell i;
                for (i[0] = 0; i[0] <= edges[0]; ++i[0]) {
                    for (i[1] = 0; i[1] <= edges[1]; ++i[1]) {
                        for (i[2] = 0; i[2] <= edges[2]; ++i[2]) {
                            const Cell at{low[0] + i[0], low[1] + i[1], low[2] + i[2]};
                            vertices[lattice_.number(at)] = between(corners, i, edges, metrics);
                        }
                    }
                }
            };
            for_each_leaf_of_brick(octree.octants(), bricks.parts[brick], {}, lattice_.cells(),
                                   enter);
            visit(brick, std::span<const Metric>(vertices).first(lattice_.vertices()));
        });
    }
    static Metric between(const Corners& corners, const Cell& i, const Cell& edges,
                          std::span<const Metric> metrics) {
        Vector t = Vector::Zero();
        std::size_t corner = 0;
        bool is_corner = true;
        for (std::size_t a = 0; a < 3; ++a) {
            if (i[a] == 0) continue;
            t[static_cast<Axis>(a)] = static_cast<double>(i[a]) / edges[a];
            corner |= std::size_t{1} << a;
            is_corner = is_corner && i[a] == edges[a];
        }
        if (is_corner) return metrics[corners[corner]];
        return blend_lengths(corner_weights(t),
                             [&](std::size_t c) -> const Metric& { return metrics[corners[c]]; });
    }
    std::vector<std::uint8_t> kinds_of(const BrickOctree& octree, const Bricks& bricks) const {
        std::vector<std::uint8_t> kinds(bricks.parts.size(), 0);
        if constexpr (Codes::are_codes) {
            for_each_brick(octree, bricks, [&](std::size_t brick, std::span<const Metric> at) {
                kinds[brick] = codes_.kind_of(at);
            });
        }
        return kinds;
    }

    [[gnu::always_inline]] BrickRef ref_at(const Cell& voxel) const {
        return {reader_(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]),
                        static_cast<std::uint32_t>(voxel[2]))};
    }
    [[gnu::always_inline]] const std::byte* brick_of(BrickRef ref) const {
        return reinterpret_cast<const std::byte*>(pool_.data()) + ref.unit() * unit_;
    }
    Metric vertex(BrickRef ref, std::uint32_t number) const {
        if constexpr (Codes::are_codes) {
            return length(number_between(ref.kind(), brick_of(ref),
                                         [&](const auto& at) { return at(number); }));
        } else {
            return Codes::at(brick_of(ref), number);
        }
    }
    // A length, of between(at): at(vertex) is the number that a vertex has.
    template <class Between>
    [[gnu::always_inline]] double number_between(
        std::uint8_t kind, const std::byte* brick,
        const Between& between) const requires Codes::are_codes {
        const auto at = [&](auto number) {
            return between([&](std::uint32_t vertex) {
                return static_cast<double>(Codes::template at<decltype(number)>(brick, vertex));
            });
        };
        if (kind == Codes::floats) return at(float());
        const auto [base, scale] = codes_.scale_of(kind, brick);
        if (kind == Codes::bytes) return base + scale * at(std::uint8_t());
        return base + scale * at(std::uint16_t());
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

    using Value = std::conditional_t<are_lengths, StoredLength<double>, Metric>;
    static Value length(double h) requires are_lengths {
        StoredLength<double> value;
        value.h = h;
        return value;
    }
    // In the cell whose low corner is a vertex of the brick.
    [[gnu::always_inline]] Value value_in(BrickRef ref, const std::byte* brick,
                                          std::uint32_t vertex, double x, double y,
                                          double z) const {
        if constexpr (Codes::are_codes) {
            return length(number_between(ref.kind(), brick, [&](const auto& number) {
                const auto at = [&](std::size_t c) { return number(vertex + to_corner_[c]); };
                return trilinear(at, x, y, z);
            }));
        } else if constexpr (are_lengths) {
            const auto at = [&](std::size_t c) {
                return double{Codes::at(brick, vertex + to_corner_[c]).h};
            };
            return length(trilinear(at, x, y, z));
        } else {
            const std::array<double, 8> weights = corner_weights({x, y, z});
            return blend<Metric>(
                8, [&](std::size_t c) { return weights[c]; },
                [&](std::size_t c) -> decltype(auto) {
                    return Codes::at(brick, vertex + to_corner_[c]);
                });
        }
    }
    Value value_at(const Point& x) const {
        const Cell voxel = voxel_of_(x);
        const BrickRef ref = ref_at(voxel);
        std::uint32_t vertex = 0;
        std::array<double, 3> t;
        for (std::size_t a = 0; a < 3; ++a) {
            const double in_voxels = voxel_of_.in_voxels(x[static_cast<Axis>(a)], a);
            const Scales& scale = scales_[a];
            const std::int32_t low = voxel[a] & scale.begin[ref.level()];
            const double in_cells = (in_voxels - low) * scale.cells[ref.level()];
            const Along in = along(in_cells, lattice_.below_end(a));
            vertex += static_cast<std::uint32_t>(in.cell) * lattice_.step(a);
            t[a] = in.t;
        }
        return value_in(ref, brick_of(ref), vertex, t[0], t[1], t[2]);
    }

    // Some places in their bricks.
    struct Batch {
        static constexpr std::size_t most = CellBatch::most;
        template <class Number>
        using Each = std::array<Number, most>;

        CellBatch in_voxels;
        Each<std::uint32_t> bits_of_refs;
        Each<BrickRef> ref;
        Each<const std::byte*> brick;
        Each<std::uint32_t> vertex;
        std::array<Each<double>, 3> t;
        // Of codes: those at the ends of the cell's edges along z, side by side in one number.
        std::array<Each<std::uint32_t>, 4> pair;
        Each<std::uint32_t> bits;
        Each<double> base, scale, value;
    };
    // put(i, value) for all places, some at a time: references first, then where places are in
    // their bricks, while these are on their way.
    template <class Put>
    void answer(std::span<const Point> x, const Put& put) const {
        Batch batch;
        for (std::size_t first = 0; first < x.size(); first += Batch::most) {
            const std::size_t count = std::min(Batch::most, x.size() - first);
            locate(x.subspan(first, count), batch);
            if constexpr (Codes::are_codes) {
                decode(count, batch);
                for (std::size_t i = 0; i < count; ++i) put(first + i, length(batch.value[i]));
            } else {
                for (std::size_t i = 0; i < count; ++i)
                    prefetch_cell(batch.brick[i], batch.vertex[i]);
                for (std::size_t i = 0; i < count; ++i) {
                    put(first + i, value_in({}, batch.brick[i], batch.vertex[i], batch.t[0][i],
                                            batch.t[1][i], batch.t[2][i]));
                }
            }
        }
    }
    void locate(std::span<const Point> x, Batch& batch) const {
        const std::size_t count = x.size();
        voxel_of_.locate(x, batch.in_voxels);
        reader_.read(batch.in_voxels, count, batch.bits_of_refs);
        for (std::size_t i = 0; i < count; ++i) {
            const BrickRef ref = batch.ref[i] = {batch.bits_of_refs[i]};
            const std::byte* brick = batch.brick[i] = brick_of(ref);
            __builtin_prefetch(brick);
            if constexpr (Codes::are_codes) __builtin_prefetch(brick + sizeof(Line));
        }
        batch.vertex.fill(0);
        for (std::size_t a = 0; a < 3; ++a) {
            const Scales& scale = scales_[a];
            const double below_end = lattice_.below_end(a);
            const std::uint32_t step = lattice_.step(a);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t level = batch.ref[i].level();
                const std::int32_t low = batch.in_voxels.cell[a][i] & scale.begin[level];
                const double in_cells = (batch.in_voxels.t[a][i] - low) * scale.cells[level];
                const Along in = along(in_cells, below_end);
                batch.vertex[i] += static_cast<std::uint32_t>(in.cell) * step;
                batch.t[a][i] = in.t;
            }
        }
    }
    // As value_in does, side by side; bricks of floats one by one. On a plane across z the second
    // code of a pair is another's, which weighs nothing.
    void decode(std::size_t count, Batch& batch) const requires Codes::are_codes {
        std::array<std::uint8_t, Batch::most> in_floats;
        std::size_t floats = 0;
        for (std::size_t i = 0; i < count; ++i) {
            in_floats[floats] = static_cast<std::uint8_t>(i);
            floats += batch.ref[i].kind() == Codes::floats ? 1 : 0;
            const std::uint8_t kind = batch.ref[i].kind() & 1;
            const std::byte* brick = batch.brick[i];
            const auto [base, scale] = codes_.scale_of(kind, brick);
            batch.base[i] = base;
            batch.scale[i] = scale;
            batch.bits[i] = Codes::code_bits(kind);
            for (std::size_t c = 0; c < 4; ++c) {
                batch.pair[c][i] = Codes::pair_at(kind, brick, batch.vertex[i] + to_corner_[c]);
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t mask = (1U << batch.bits[i]) - 1;
            const auto at = [&](std::size_t c) {
                const std::uint32_t code = batch.pair[c & 3][i] >> (c < 4 ? 0 : batch.bits[i]);
                return static_cast<double>(static_cast<std::int32_t>(code & mask));
            };
            batch.value[i] =
                batch.base[i] +
                batch.scale[i] * trilinear(at, batch.t[0][i], batch.t[1][i], batch.t[2][i]);
        }
        for (const std::uint8_t i : std::span(in_floats).first(floats)) {
            batch.value[i] = value_in(batch.ref[i], batch.brick[i], batch.vertex[i], batch.t[0][i],
                                      batch.t[1][i], batch.t[2][i])
                                 .h;
        }
    }
    // The four edges along z.
    [[gnu::always_inline]] void prefetch_cell(const std::byte* brick, std::uint32_t vertex) const
        requires(!Codes::are_codes) {
        for (std::size_t c = 0; c < 4; ++c) {
            __builtin_prefetch(&Codes::at(brick, vertex + to_corner_[c]));
        }
    }

    VoxelOfPlace voxel_of_;
    BrickLattice lattice_;
    std::array<std::uint32_t, 8> to_corner_ = lattice_.to_corners();
    std::size_t unit_ = Codes::unit(lattice_.vertices());
    Codes codes_;
    Cuts cuts_;
    std::size_t cells_, control_nodes_;
    std::vector<std::uint8_t> kinds_;  // of the bricks, where there are several
    Tree tree_{0};
    std::vector<Line> pool_;
    std::array<Scales, 3> scales_;
    std::shared_ptr<const BrickOctree> octree_;
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
        using Form = VdbBricks<M, VdbTree543<std::uint32_t>>;
        state.require(Form::is_sound(*saved_, bricks, domain()), "bricks.pool",
                      "does not fit its tree, or holds what are no metrics");
    });
}

std::unique_ptr<ControlSpace> BrickOctree::finished(
    const std::shared_ptr<const BrickOctree>& octree, std::optional<Precision> precision) {
    const Bricks bricks(octree->octants());
    const auto made = [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
        const auto in_tree = [&]<class Tree>(std::type_identity<Tree>) {
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

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_bricks(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<BrickOctree>>(options);
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/octree_file.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "baselines/openvdb/brick_octree.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "controlspace/metric/stored_metrics.h"
#include "controlspace/trees/node_metrics.h"
#include "controlspace/version.h"
#include "refuse.h"
#include "space/sealed_vdb.h"
#include "trees/topology/topology_state.h"

namespace controlspace {
namespace {

constexpr const char *length_grid = "length", *scale_note = "scale",
                     *state_note = "controlspace_state";

std::string grid_of_level(int level) { return fmt::format("{}_{}", length_grid, level); }

class Archive : public openvdb::io::Archive {
public:
    Archive() { setCompression(openvdb::io::COMPRESS_ACTIVE_MASK | openvdb::io::COMPRESS_BLOSC); }
    /// With the places of grids, by which programs read one without the others.
    void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids,
                  const openvdb::MetaMap& notes) const {
        write(stream, grids, /*seekable=*/true, notes);
    }
};

std::string hexadecimal(std::string_view bytes) {
    std::string digits;
    digits.reserve(2 * bytes.size());
    for (const char byte : bytes) {
        fmt::format_to(std::back_inserter(digits), "{:02x}", static_cast<unsigned char>(byte));
    }
    return digits;
}

std::string bytes_of(std::string_view digits) {
    std::string bytes(digits.size() / 2, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        unsigned char byte = 0;
        std::from_chars(&digits[2 * i], &digits[2 * i] + 2, byte, 16);
        bytes[i] = static_cast<char>(byte);
    }
    return bytes;
}

// Of a lattice with so many edges along each axis.
Vector edges_of(const Box& domain, const Cell& count) {
    Vector edges;
    for (Axis a = 0; a < 3; ++a) {
        edges[a] = domain.edges()[a] / std::max(count[static_cast<std::size_t>(a)], 1);
    }
    // OpenVDB has no flat ones.
    for (Axis a = 0; a < 3; ++a) {
        if (!(edges[a] > 0)) edges[a] = edges.maxCoeff();
    }
    return edges;
}

// OpenVDB refuses transforms of a volume below 3e-15. Powers of two change no digits of lengths.
double scale_of(const Vector& finest_edges) {
    constexpr double smallest = 2e-5;
    const double shortest = finest_edges.minCoeff();
    return shortest < smallest ? std::exp2(std::ceil(std::log2(smallest / shortest))) : 1;
}

openvdb::Vec3DMetadata note_of(const Point& x) { return openvdb::Vec3d(x.x(), x.y(), x.z()); }

// The grids of one file.
class GridMaker {
public:
    GridMaker(const Box& domain, const Vector& finest_edges, float longest)
        : domain_(domain), scale_(scale_of(finest_edges)), background_(in_file(longest)) {}

    float in_file(float h) const { return static_cast<float>(scale_ * h); }
    /// Index (0, 0, 0) is at `first`.
    openvdb::FloatGrid::Ptr make(const std::string& name, const Point& first,
                                 const Vector& edges) const {
        const Vector e = scale_ * edges;
        const Point o = scale_ * first;
        auto transform = openvdb::math::Transform::createLinearTransform(1);
        transform->postScale({e.x(), e.y(), e.z()});
        transform->postTranslate({o.x(), o.y(), o.z()});
        auto grid = openvdb::FloatGrid::create(background_);
        grid->setName(name);
        grid->setTransform(transform);
        grid->setCreator("controlspace " + std::string(version()));
        grid->insertMeta("domain_low", note_of(domain_.low));
        grid->insertMeta("domain_high", note_of(domain_.high));
        if (scale_ != 1) grid->insertMeta(scale_note, openvdb::DoubleMetadata(scale_));
        return grid;
    }

private:
    Box domain_;
    double scale_;
    float background_;
};

// The file of some grids; the octree is added to the state.
std::string file_of(const openvdb::GridCPtrVec& grids, const Octants& octree, StateWriter& state) {
    save(octree, state);
    openvdb::MetaMap notes;
    notes.insertMeta(std::string(seal_name), openvdb::StringMetadata(std::string(unsealed)));
    notes.insertMeta(state_note, openvdb::StringMetadata(hexadecimal(state.bytes())));
    std::ostringstream stream;
    Archive().write_to(stream, grids, notes);
    return std::move(stream).str();
}

// The lengths in a grid of such a file.
class GridReader {
public:
    explicit GridReader(openvdb::FloatGrid::ConstPtr grid)
        : grid_(std::move(grid)), values_(grid_->getConstAccessor()) {
        const auto note = grid_->getMetadata<openvdb::DoubleMetadata>(scale_note);
        if (note != nullptr) scale_ = note->value();
    }
    double operator()(const openvdb::Coord& at) const { return values_.getValue(at) / scale_; }

private:
    openvdb::FloatGrid::ConstPtr grid_;
    openvdb::FloatGrid::ConstAccessor values_;
    double scale_ = 1;
};

openvdb::FloatGrid::ConstPtr find_grid(const openvdb::GridPtrVec& grids, const std::string& name) {
    const auto found =
        std::ranges::find_if(grids, [&](const auto& grid) { return grid->getName() == name; });
    return found == grids.end() ? nullptr : openvdb::gridPtrCast<openvdb::FloatGrid>(*found);
}

// visit(vertex, at) for the vertices of a brick: their numbers, and where they are among those of
// its level.
template <class Visit>
void for_each_vertex(const VoxelBox& brick, const BrickLattice& lattice, const Visit& visit) {
    const Cell& cells = lattice.cells();
    Cell first, i;
    for (std::size_t a = 0; a < 3; ++a) first[a] = brick.low[a] / brick.edges[a] * cells[a];
    for (i[0] = 0; i[0] <= cells[0]; ++i[0]) {
        for (i[1] = 0; i[1] <= cells[1]; ++i[1]) {
            for (i[2] = 0; i[2] <= cells[2]; ++i[2]) {
                visit(lattice.number(i),
                      openvdb::Coord(first[0] + i[0], first[1] + i[1], first[2] + i[2]));
            }
        }
    }
}

// visit(level, its bricks' numbers) for each level that has some.
template <class Visit>
void for_each_level(const Bricks& bricks, const Visit& visit) {
    for (int level = 0; level <= std::ranges::max(bricks.level); ++level) {
        std::vector<std::size_t> numbers;
        for (std::size_t brick = 0; brick < bricks.level.size(); ++brick) {
            if (bricks.level[brick] == level) numbers.push_back(brick);
        }
        if (!numbers.empty()) visit(level, numbers);
    }
}

void add_metrics(const GridReader& length_at, const Octants& octree, StateWriter& state) {
    std::vector<Metric> metrics;
    metrics.reserve(octree.leaves());
    for (const VoxelBox& leaf : VoxelBoxes(octree).leaves) {
        metrics.push_back(Metric::isotropic(length_at({leaf.low[0], leaf.low[1], leaf.low[2]})));
    }
    NodeMetrics::exchange(NodeMetrics(std::move(metrics)), state);
}

void add_bricks(const openvdb::GridPtrVec& grids, const Octants& octree, const std::string& file,
                StateWriter& state) {
    const Bricks bricks(octree);
    const BrickLattice lattice(octree.domain());
    const std::size_t size = BrickCodes<StoredLength<float>>::bytes_of(0, lattice.vertices());
    const std::size_t count = bricks.parts.size();
    SavedBricks saved{
        true, std::vector<std::uint8_t>(count * size), std::vector<std::uint8_t>(count), {}};
    for_each_level(bricks, [&](int level, std::span<const std::size_t> numbers) {
        const auto grid = find_grid(grids, grid_of_level(level));
        if (grid == nullptr) refuse("{}: its grid {} is missing", file, grid_of_level(level));
        const GridReader length_at(grid);
        for (const std::size_t brick : numbers) {
            for_each_vertex(bricks.boxes.leaves[brick], lattice,
                            [&](std::uint32_t vertex, const openvdb::Coord& at) {
                                const auto h = static_cast<float>(length_at(at));
                                std::memcpy(&saved.pool[brick * size + vertex * sizeof h], &h,
                                            sizeof h);
                            });
        }
    });
    SavedBricks::exchange(saved, state);
}

}  // namespace

std::vector<float> lengths_in_floats(std::span<const Metric> isotropic) {
    const StoredMetrics<StoredLength<float>> stored(isotropic);
    std::vector<float> lengths;
    lengths.reserve(stored.size());
    for (const StoredLength<float>& length : stored.items()) lengths.push_back(length.h);
    return lengths;
}

std::string tiles_file(StateWriter state, const Octants& octree, std::span<const float> lengths) {
    openvdb::initialize();
    const VoxelBoxes boxes(octree);
    const Box& domain = octree.domain();
    const Vector edges = edges_of(domain, boxes.voxels);
    const GridMaker maker(domain, edges, std::ranges::max(lengths));
    const auto grid = maker.make(length_grid, domain.low + 0.5 * edges, edges);
    fill(grid->tree(), boxes, [&](LeafIndex leaf) { return maker.in_file(lengths[leaf]); });
    return file_of({grid}, octree, state);
}

std::string bricks_file(StateWriter state, const Octants& octree, std::span<const float> lengths) {
    openvdb::initialize();
    const Bricks bricks(octree);
    const Box& domain = octree.domain();
    const BrickLattice lattice(domain);
    const auto edges_with = [&](const VoxelBox& brick) {
        Cell cells = bricks.boxes.voxels;
        for (std::size_t a = 0; a < 3; ++a)
            cells[a] = cells[a] / brick.edges[a] * lattice.cells()[a];
        return edges_of(domain, cells);
    };
    const GridMaker maker(domain, edges_with({0, {0, 0, 0}, {1, 1, 1}}), std::ranges::max(lengths));
    openvdb::GridCPtrVec grids;
    for_each_level(bricks, [&](int level, std::span<const std::size_t> numbers) {
        const std::span<const VoxelBox> boxes = bricks.boxes.leaves;
        const auto grid =
            maker.make(grid_of_level(level), domain.low, edges_with(boxes[numbers.front()]));
        auto values = grid->getAccessor();
        for (const std::size_t brick : numbers) {
            const auto of_brick = lengths.subspan(brick * lattice.vertices(), lattice.vertices());
            for_each_vertex(boxes[brick], lattice,
                            [&](std::uint32_t vertex, const openvdb::Coord& at) {
                                values.setValue(at, maker.in_file(of_brick[vertex]));
                            });
        }
        grids.push_back(grid);
    });
    return file_of(grids, octree, state);
}

std::string state_in_octree_file(const std::string& bytes, const std::string& file) {
    openvdb::initialize();
    try {
        std::istringstream stream(bytes);
        openvdb::io::Stream read(stream, /*delayLoad=*/false);
        const std::string state = bytes_of(read.getMetadata()->metaValue<std::string>(state_note));
        const StateReader reader(state, file);
        Box domain;
        reader("options.domain", domain);
        const auto octree = load_topology<OctreeNode>(domain, reader);
        StateWriter whole(state);
        const openvdb::GridPtrVec& grids = *read.getGrids();
        if (const auto tiles = find_grid(grids, length_grid)) {
            add_metrics(GridReader(tiles), octree, whole);
        } else {
            add_bricks(grids, octree, file, whole);
        }
        return whole.bytes();
    } catch (const openvdb::Exception& error) {
        refuse("{}: OpenVDB cannot read it ({})", file, error.what());
    }
}

}  // namespace controlspace

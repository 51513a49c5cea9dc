// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/tiles_file.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "controlspace/trees/detail/topology_state.h"
#include "controlspace/trees/node_metrics.h"
#include "controlspace/version.h"
#include "refuse.h"
#include "space/sealed_vdb.h"

namespace controlspace {
namespace {

constexpr const char *length_grid = "length", *scale_note = "scale",
                     *state_note = "controlspace_state";

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

Vector voxel_of(const Box& domain, const Cell& voxels) {
    Vector edges;
    for (Axis a = 0; a < 3; ++a) {
        edges[a] = domain.edges()[a] / voxels[static_cast<std::size_t>(a)];
    }
    // OpenVDB has no flat ones.
    for (Axis a = 0; a < 3; ++a) {
        if (!(edges[a] > 0)) edges[a] = edges.maxCoeff();
    }
    return edges;
}

// OpenVDB refuses transforms of a volume below 3e-15. Powers of two change no digits of lengths.
double scale_of(const Vector& voxel) {
    constexpr double smallest = 2e-5;
    const double shortest = voxel.minCoeff();
    return shortest < smallest ? std::exp2(std::ceil(std::log2(smallest / shortest))) : 1;
}

// From indices, which are centres of voxels.
openvdb::math::Transform::Ptr transform_of(const Point& low, const Vector& voxel) {
    const Point first = low + 0.5 * voxel;
    auto transform = openvdb::math::Transform::createLinearTransform(1);
    transform->postScale({voxel.x(), voxel.y(), voxel.z()});
    transform->postTranslate({first.x(), first.y(), first.z()});
    return transform;
}

openvdb::Vec3DMetadata note_of(const Point& x) { return openvdb::Vec3d(x.x(), x.y(), x.z()); }

}  // namespace

std::string tiles_file(StateWriter state, const Octants& octree, std::span<const float> lengths) {
    openvdb::initialize();
    save(octree, state);
    const VoxelBoxes boxes(octree);
    const Vector voxel = voxel_of(octree.domain(), boxes.voxels);
    const double scale = scale_of(voxel);
    const auto in_file = [&](float h) { return static_cast<float>(scale * h); };
    const auto grid = openvdb::FloatGrid::create(in_file(std::ranges::max(lengths)));
    fill(grid->tree(), boxes, [&](LeafIndex leaf) { return in_file(lengths[leaf]); });
    grid->setName(length_grid);
    grid->setTransform(transform_of(scale * octree.domain().low, scale * voxel));
    grid->setCreator("controlspace " + std::string(version()));
    grid->insertMeta("domain_low", note_of(octree.domain().low));
    grid->insertMeta("domain_high", note_of(octree.domain().high));
    if (scale != 1) grid->insertMeta(scale_note, openvdb::DoubleMetadata(scale));
    openvdb::MetaMap notes;
    notes.insertMeta(std::string(seal_name), openvdb::StringMetadata(std::string(unsealed)));
    notes.insertMeta(state_note, openvdb::StringMetadata(hexadecimal(state.bytes())));
    std::ostringstream stream;
    Archive().write_to(stream, {grid}, notes);
    return std::move(stream).str();
}

std::string state_in_tiles_file(const std::string& bytes, const std::string& file) {
    openvdb::initialize();
    try {
        std::istringstream stream(bytes);
        openvdb::io::Stream read(stream, /*delayLoad=*/false);
        const std::string state = bytes_of(read.getMetadata()->metaValue<std::string>(state_note));
        const StateReader reader(state, file);
        Box domain;
        reader("options.domain", domain);
        const auto octree = load_topology<OctreeNode>(domain, reader);

        const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(read.getGrids()->at(0));
        const double scale = grid->getMetadata<openvdb::DoubleMetadata>(scale_note) != nullptr
                                 ? grid->metaValue<double>(scale_note)
                                 : 1;
        const auto values = grid->getConstAccessor();
        std::vector<Metric> metrics;
        metrics.reserve(octree.leaves());
        for (const VoxelBox& leaf : VoxelBoxes(octree).leaves) {
            const float h = values.getValue({leaf.low[0], leaf.low[1], leaf.low[2]});
            metrics.push_back(Metric::isotropic(h / scale));
        }
        StateWriter whole(state);
        NodeMetrics::exchange(NodeMetrics(std::move(metrics)), whole);
        return whole.bytes();
    } catch (const openvdb::Exception& error) {
        refuse("{}: OpenVDB cannot read it ({})", file, error.what());
    }
}

}  // namespace controlspace

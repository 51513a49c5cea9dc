#include "baselines/openvdb_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "baselines/level_nodes.h"
#include "baselines/vdb_prune.h"
#include "error.h"

namespace controlspace {

namespace {

using Coord = openvdb::Coord;
using Trees = std::vector<VdbLevelTree>;

constexpr std::size_t leaf_payload = VdbLevelTree::LeafNodeType::SIZE * sizeof(VdbMetric);

// `Values` is CellMetrics or VertexMetrics.
template <class Values>
class LevelSpace final : public ControlSpace {
public:
    explicit LevelSpace(const SpaceOptions& options)
        : options_(options),
          cells_(choose_levels(options)),
          trees_(static_cast<std::size_t>(cells_.levels()), VdbLevelTree(no_metric)) {
        LevelWriter at(trees_);
        Values::fill(at, cells_, largest_metric(options.domain));
        voxels_ = active_voxels();
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const LevelReader at(trees_);
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = value(at, cells_.place(x[i]));
    }

    Insertion insert(const PointSource& source) override {
        return insert(std::span(&source, 1)).inserted == 1 ? Insertion::inserted
                                                           : Insertion::already_met;
    }

    InsertionReport insert(std::span<const PointSource> sources) override {
        InsertionReport report;
        LevelWriter at(trees_);
        const LevelReader reader(trees_);
        for (const PointSource& source : sources) {
            require_valid(source, report.sources++, domain());
            if (insert_valid(at, reader, source)) ++report.inserted;
        }
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        const LevelNodes nodes = numbered();
        return {nodes.graph(neighbourhood), nodes.metrics()};
    }

    void assign(std::span<const Metric> metrics) override { numbered().assign(metrics, trees_); }

    GradationReport grade(const GradationOptions& options) override {
        GradationReport report;
        std::uint64_t operations = 0;
        for (bool refined = true; refined;) {
            require_memory();
            const std::vector<Metric> before = numbered().metrics();
            report = ControlSpace::grade(options);
            operations += report.operations;
            const auto long_voxels = voxels_longer_than_wanted();
            refined = !long_voxels.empty();
            if (!refined) break;
            assign(before);
            LevelWriter at(trees_);
            for (const auto& [level, c] : long_voxels) split(at, level, c);
            clear();
        }
        report.operations = operations;
        for (VdbLevelTree& tree : trees_) prune_metrics(tree, {.delta = options_.prune_delta});
        return report;
    }

    const Box& domain() const override { return cells_.domain(); }

    Box element_at(const Point& x) const override {
        const Coord finest = cells_.place(x).finest;
        const int level = LevelReader(trees_).level_at(finest);
        return cells_.box(level, finest >> static_cast<std::size_t>(level));
    }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.elements = voxels_;
        footprint.control_nodes = numbered().size();
        int finest = cells_.top();
        int coarsest = 0;
        for (int level = 0; level <= cells_.top(); ++level) {
            const VdbLevelTree& tree = trees_[static_cast<std::size_t>(level)];
            if (tree.activeVoxelCount() > 0) {
                finest = std::min(finest, level);
                coarsest = std::max(coarsest, level);
            }
            footprint.bytes_payload += tree.leafCount() * leaf_payload;
        }
        footprint.bytes_topology = bytes() - footprint.bytes_payload;
        footprint.depth = coarsest - finest + 1;
        footprint.remark =
            fmt::format("voxels of {:.3g} to {:.3g}", cells_.edges(finest).maxCoeff(),
                        cells_.edges(coarsest).maxCoeff());
        return footprint;
    }

private:
    LevelNodes numbered() const { return {cells_, trees_, Values::interpolation}; }

    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const VdbLevelTree& tree : trees_) bytes += tree.memUsage();
        return bytes;
    }
    std::size_t active_voxels() const {
        std::size_t voxels = 0;
        for (const VdbLevelTree& tree : trees_) voxels += tree.activeVoxelCount();
        return voxels;
    }

    Metric value(const LevelReader& at, const LevelCells::Place& place) const {
        const int level = at.level_at(place.finest);
        return Values::value(at, level, place.finest >> static_cast<std::size_t>(level), place.t);
    }

    bool is_longer(int level, const Metric& metric, double length) const {
        const auto lengths = metric_edge_lengths(metric, cells_.edges(level));
        return std::max({lengths[0], lengths[1], lengths[2]}) > length;
    }

    bool insert_valid(LevelWriter& at, const LevelReader& reader, const PointSource& source) {
        const LevelCells::Place place = cells_.place(source.position);
        if (!calls_for_change(source.metric, value(reader, place), options_.tolerance)) {
            return false;
        }
        int level = reader.level_at(place.finest);
        for (; level > 0 && is_longer(level, source.metric, options_.l_min); --level) {
            split(at, level, place.finest >> static_cast<std::size_t>(level));
        }
        Values::lower(at, level, place.finest >> static_cast<std::size_t>(level), source.metric);
        return true;
    }

    void split(LevelWriter& at, int level, const Coord& c) {
        if (voxels_ >= next_look_) require_memory();
        Values::split(at, level, c);
        voxels_ += 7;
    }

    // Stops a structure that outgrows the cap, long before the system stops the program.
    void require_memory() {
        const std::size_t gradation = voxels_ * gradation_bytes_per_voxel;
        if (bytes() + gradation > options_.max_bytes) {
            throw InputError(
                fmt::format("a grid in levels would take more than {:.3g} GiB, gradation included: "
                            "raise voxel, "
                            "voxel_factor or max_memory",
                            static_cast<double>(options_.max_bytes) / (1 << 30)));
        }
        next_look_ = voxels_ + voxels_ / 16;
    }

    std::vector<std::pair<int, Coord>> voxels_longer_than_wanted() const {
        std::vector<std::pair<int, Coord>> found;
        const LevelReader at(trees_);
        for (int level = 1; level <= cells_.top(); ++level) {
            const VdbLevelTree& tree = trees_[static_cast<std::size_t>(level)];
            for (auto voxel = tree.cbeginValueOn(); voxel; ++voxel) {
                bool longer = false;
                Values::for_each_metric(at, level, voxel.getCoord(), [&](const Metric& metric) {
                    longer = longer || is_longer(level, metric, options_.voxel_factor);
                });
                if (longer) found.emplace_back(level, voxel.getCoord());
            }
        }
        return found;
    }

    // Takes away leaves that hold nothing any more.
    void clear() {
        for (VdbLevelTree& tree : trees_) prune_metrics(tree, {.delta = 0});
    }

    // Numbers, graph and copies of metrics, as counted on spheres: 180 bytes for a voxel; for its
    // vertices 330, and up to 500 where few of them are shared.
    static constexpr std::size_t gradation_bytes_per_voxel =
        Values::interpolation == Interpolation::nearest ? 250 : 600;

    SpaceOptions options_;
    LevelCells cells_;
    Trees trees_;
    std::size_t voxels_ = 0;           // that are active
    std::size_t next_look_ = 1 << 12;  // number of voxels at which memory is looked at again
};

}  // namespace

std::unique_ptr<ControlSpace> make_openvdb_levels(const SpaceOptions& options,
                                                  Interpolation interpolation) {
    if (interpolation == Interpolation::nearest) {
        return std::make_unique<LevelSpace<CellMetrics>>(options);
    }
    return std::make_unique<LevelSpace<VertexMetrics>>(options);
}

}  // namespace controlspace

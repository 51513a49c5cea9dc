// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baselines/lattice/voxels.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"
#include "space/given_sources.h"
#include "space/state.h"

namespace controlspace {

class LatticeData;

/// A grid of some system, as its builder needs it.
struct GridKind {
    Interpolation interpolation;
    /// What the finished grid of so many nodes along x, y and z will allocate.
    double (*bytes_for)(const Vector& nodes);
    /// The finished grid; without a precision as the builder holds it.
    std::unique_ptr<ControlSpace> (*finish)(const std::shared_ptr<const LatticeData>&,
                                            std::optional<Precision>);
    /// What the grid makes of a metric, if it does not keep all bits. Throws InputError for one
    /// that it cannot keep.
    Metric (*stored)(const Metric&) = nullptr;

    Metric kept(const Metric& m) const { return stored == nullptr ? m : stored(m); }
    void keep(std::vector<Metric>& metrics) const {
        if (stored == nullptr) return;
        for (Metric& metric : metrics) metric = stored(metric);
    }
};

/// Writes what LatticeData::load reads.
void save_lattice(const std::vector<Metric>& field, double chosen_voxel, StateWriter& state);

/// What SharedBuilder makes grids with a regular lattice of nodes from, whatever their system: a
/// flat array of metrics is filled and graded; the finished grid is made of it, in parallel, by the
/// means of its own system.
///
/// Voxels are those of choose_voxels. Throws InputError as that does, and where later sources are
/// to come to a grid that joins nodes or rounds metrics: it does not keep what they would need.
class LatticeData {
public:
    LatticeData(const SpaceOptions& options, const GridKind& kind);

    InsertionReport insert(std::span<const PointSource> sources);
    GradationReport grade(const NodeGradation& gradation);
    /// Chooses the voxels, the largest that keep the target (LatticeFit), where the options gave
    /// none; keeps those that were given.
    AdaptationReport adapt(const AdaptationGoal& goal);
    ControlNodes control_nodes(Neighbourhood neighbourhood) const;
    void assign(std::span<const Metric> metrics);
    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const LatticeData>& data,
                                                  std::optional<Precision> precision);

    void save(StateWriter& state) const { save_lattice(field(), chosen_voxel_, state); }
    void load(const StateReader& state);

    const Box& domain() const { return options_.domain; }
    const SpaceOptions& options() const { return options_; }
    static constexpr int order() { return 1; }  // of interpolation, at most
    const Vector& cells() const { return voxels_.cells; }
    Lattice lattice(Neighbourhood neighbourhood = Neighbourhood::faces) const;
    /// What the memory cap has cost, see Footprint::remark.
    const std::string& remark() const { return voxels_.remark; }
    /// Metrics of all nodes, x fastest.
    const std::vector<Metric>& field() const;
    /// By adaptation; 0 where it chose none.
    double chosen_voxel() const { return chosen_voxel_; }

private:
    template <Interpolation interpolation>
    InsertionReport insert_between(std::span<const PointSource> sources);
    Voxels voxels_of(const SpaceOptions& options) const;

    SpaceOptions options_;  // with the voxel that was chosen, if one was
    GridKind kind_;
    bool chooses_voxels_;
    double chosen_voxel_ = 0;
    Voxels voxels_;
    mutable std::vector<Metric> field_;  // empty until it is needed, so that files can be checked
};

}  // namespace controlspace

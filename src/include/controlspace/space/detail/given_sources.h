#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/ordered_metrics.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/detail/own_growths.h"
#include "controlspace/space/detail/state.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// All sources that were given to a builder, whether they changed it or not: what it grades by
/// (GradationSchedule::sources). 32 bytes for each as long as all are isotropic, 72 otherwise; 8
/// more where some have gradation ratios of their own.
class GivenSources {
public:
    void add(std::span<const PointSource> sources);

    std::size_t size() const { return positions_.size(); }
    std::vector<PointSource> all() const;
    /// Whether none has a gradation ratio of its own.
    bool all_grow_alike() const { return growths_.empty(); }
    /// The largest gradation ratio of all, in a field of ratio g.
    double largest_growth(double g) const;
    /// Bytes allocated.
    std::size_t bytes() const;

    void save(StateWriter& state) const;
    static bool are_in(const StateReader& state);
    /// Throws InputError where they are not sound.
    void load(const StateReader& state);

private:
    std::vector<Point> positions_;
    std::vector<double> lengths_;  // as long as all are isotropic
    std::vector<Metric> metrics_;  // otherwise
    OwnGrowths growths_;
};

/// Throws InputError if a source has a gradation ratio of its own: where the sources before it are
/// not known, nodes are graded one by the other.
void require_alike_growth(std::span<const PointSource> sources);

/// How a builder grades its control nodes: by the exact field of the sources it was given, or else
/// by the law, from node to node.
struct NodeGradation {
    /// `given`: null where they are not known. Throws InputError as require_valid(options) does,
    /// and for sources with ratios of their own if they are not to be graded by the exact field.
    NodeGradation(const GradationOptions& options, const GivenSources* given,
                  const SpaceOptions& space);

    GradationOptions options;  ///< `schedule` is `sources` only with a field
    std::unique_ptr<const ControlSpace> field;
    double largest_ratio;  ///< of all cones
};

/// Sets control nodes at `x` to the field, but intersects them with it where it is more than twice
/// as long as what they request, on all of TBB's threads.
GradationReport grade_to(const ControlSpace& field, std::span<const Point> x,
                         OrderedMetrics metrics);

}  // namespace controlspace

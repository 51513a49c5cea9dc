#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/insertion.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// What a structure consists of and what it holds in memory, in bytes that are really allocated
/// (capacities, not sizes). The object itself and the allocator's own overhead are not counted.
struct Footprint {
    std::size_t elements = 0;         ///< leaves and inner nodes of a tree; cells of a grid
    std::size_t leaves = 0;           ///< 0 where the structure has none
    std::size_t control_nodes = 0;    ///< places that carry a metric
    int depth = 0;                    ///< levels, the root being level 1; 1 for a grid
    std::size_t bytes_payload = 0;    ///< the metrics
    std::size_t bytes_topology = 0;   ///< what finds them
    std::size_t bytes_auxiliary = 0;  ///< what only speeds something up, or serves insertion alone
    /// Bytes as the paper's Table 1 counts them (see published_bytes); none outside its structures.
    std::optional<std::size_t> bytes_published;
    /// What the structure had to give up, or nothing: "512^3; 1024^3 would need 51 GB".
    std::string remark;

    std::size_t bytes_total() const { return bytes_payload + bytes_topology + bytes_auxiliary; }
};

/// Control nodes with their metrics, detached from the structure that they came from.
struct ControlNodes {
    ControlGraph graph;
    std::vector<Metric> metrics;
};

/// How a structure was made.
struct Making {
    std::string structure;  ///< id in the catalogue
    SpaceOptions options;
    std::optional<Precision> frozen = {};  ///< made compact, and only read (ControlSpace::freeze)
    std::string saved_by = {};  ///< "controlspace 0.1.0, format 1"; empty where it was not loaded
};

class StateWriter;
class StateReader;

/// A metric at every point of a box, learnt from point sources (paper §2-3).
///
/// A new control space holds M_max = H I everywhere, H the half diagonal of its domain. Points
/// outside the domain are answered as the nearest point of the domain would be; no coordinate may
/// be NaN. Reading is thread-safe as long as nobody writes.
class ControlSpace {
public:
    virtual ~ControlSpace() = default;

    /// Metrics at `x`; out.size() == x.size(). The access time t_a of the paper is this call's
    /// duration divided by x.size().
    virtual void sample(std::span<const Point> x, std::span<Metric> out) const = 0;

    /// Paper §3.1 steps 1-6 for one source. Throws InputError as require_valid does.
    virtual Insertion insert(const PointSource& source) = 0;

    /// The same as inserting one by one, in order; a structure may do it faster, never differently.
    virtual InsertionReport insert(std::span<const PointSource> sources) = 0;

    /// Control nodes in the structure's own order (trees: depth first), for gradation; and the way
    /// back: metrics in that very order.
    virtual ControlNodes control_nodes(Neighbourhood neighbourhood) const = 0;
    virtual void assign(std::span<const Metric> metrics) = 0;

    /// Makes the field grow smoothly (paper §3.2). Structures whose control nodes carry metrics are
    /// graded alike, over the neighbours that neighbourhood_of(options) names; those that keep
    /// sources hand nothing on. Throws InputError for a ratio below 1 or not finite, and where so
    /// many neighbours would outgrow the cap on memory.
    virtual GradationReport grade(const GradationOptions& options);

    /// Replaces all that was held by the field of `goal`, with few elements that keep within its
    /// target. A tree is built anew from its root, without regard to l_min; a grid keeps its
    /// voxels. What could not be reached is said in the report. Throws InputError as GoalField
    /// does, and where the structure would outgrow its cap on memory; the field is undefined then.
    virtual AdaptationReport adapt(const AdaptationGoal& goal);

    /// A compact copy that answers alike but is only read: insert, assign, grade and adapt throw
    /// InputError. With doubles it answers the same bits; floats round the metrics by 6e-8. Throws
    /// InputError for a structure that has no such form, and for metrics that floats cannot hold
    /// (beyond 1e-38 to 3e38, or with lengths in ratios above about 1e4).
    virtual std::unique_ptr<ControlSpace> freeze(Precision precision) const;

    /// Writes all that it holds, but for what it was made with; and takes that back, in a structure
    /// made alike. To be called through `save_control_space` and `load_control_space`. Throw
    /// InputError where a structure cannot be saved, and where what is read is not sound; the field
    /// is undefined then.
    virtual void save(StateWriter& state) const;
    virtual void load(const StateReader& state);

    /// Name and options in the catalogue that it was made by; none if it was made in another way.
    const std::optional<Making>& making() const { return making_; }
    void set_making(Making making) { making_ = std::move(making); }

    virtual const Box& domain() const = 0;

    /// The element that answers for `x`: a leaf of a tree, a cell of a grid.
    virtual Box element_at(const Point& x) const = 0;
    virtual Footprint footprint() const = 0;

private:
    std::optional<Making> making_;
};

/// Metric at one point; for many, `sample` is far faster.
Metric sample_at(const ControlSpace& space, const Point& x);

/// Throws InputError, naming the source by `index` (0-based), if its position is outside `domain`
/// or its metric not positive definite.
void require_valid(const PointSource& source, std::size_t index, const Box& domain);
/// Whether it does not.
bool is_valid(const PointSource& source, const Box& domain);

}  // namespace controlspace

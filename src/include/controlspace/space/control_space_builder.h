// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "controlspace/geometry/box.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/insertion.h"

namespace controlspace {

struct BuildOptions {
    /// A form that is only read, for a CatalogueEntry that has CompactForm, in these numbers: where
    /// all metrics are isotropic, their lengths alone. Doubles answer the same bits; floats round
    /// metrics by 6e-8. Codes hold lengths alone: log16 rounds them by a relative 1e-4, log8 by
    /// half of 255 equal ratios from the shortest to the longest, (longest / shortest)^(1/510) - 1.
    /// None: as the builder holds it, metrics in doubles.
    std::optional<Precision> precision = {};
};

/// Makes a control space from point sources (paper §2-3), or from a field.
///
/// A new one holds M_max = H I everywhere, H the half diagonal of its domain. Only one thread may
/// use it at a time.
class ControlSpaceBuilder {
public:
    virtual ~ControlSpaceBuilder() = default;

    /// Paper §3.1 steps 1-6 for one source after the other, in order; a structure may do it faster,
    /// never differently. Throws InputError as require_valid does; the sources before are inserted.
    virtual InsertionReport insert(std::span<const PointSource> sources) = 0;
    /// One source.
    Insertion insert(const PointSource& source);
    /// Many sources, which are not copied where a builder keeps those it is given. None is inserted
    /// where one is refused.
    virtual InsertionReport insert(const SourceColumns& sources);

    /// Makes the field grow smoothly (paper §3.2). Structures whose control nodes carry metrics are
    /// graded alike: by default the nodes keep to the exact field of all sources so far, for
    /// which builders keep these (32 bytes each, tensors 72); otherwise over the neighbours that
    /// neighbourhood_of(options) names. Structures that keep sources answer their cones of this
    /// ratio. Throws InputError for a ratio below 1 or not finite, and where so many neighbours
    /// would outgrow the cap on memory.
    virtual GradationReport grade(const GradationOptions& options) = 0;

    /// Replaces all that was held by the field of `goal`, with few cells that keep within its
    /// target. A tree is built anew from its root, without regard to l_min; a grid chooses the
    /// largest voxels that keep the target, unless SpaceOptions::voxel gives them (one that is
    /// loaded keeps those that were chosen). The report
    /// states what could not be reached. Throws InputError for a goal that is not valid, and where
    /// the structure would outgrow its cap on memory; the field is undefined then.
    virtual AdaptationReport adapt(const AdaptationGoal& goal) = 0;

    /// The control space made so far. It stays as it is while the builder goes on; both share their
    /// data until then, so that this costs no copy. Throws InputError where a precision is
    /// requested of a structure that has no choice, and for metrics that floats cannot hold (beyond
    /// 1e-38 to 3e38, or with lengths in ratios above about 1e4) or codes (tensors; in 16 bits
    /// lengths of more than 4.9e5 times the shortest).
    virtual std::unique_ptr<ControlSpace> build(const BuildOptions& options = {}) = 0;

    virtual Box domain() const = 0;
};

/// A builder of a structure whose control nodes carry metrics.
class NodeBuilder : public ControlSpaceBuilder, public HasControlNodes {
public:
    /// Sets the metrics, in the order of control_nodes(). Throws InputError for another number.
    virtual void assign(std::span<const Metric> metrics) = 0;

    /// Grades a copy of the control nodes from node to node and assigns it: it knows no sources.
    GradationReport grade(const GradationOptions& options) override;
    /// Sets the control nodes to the field.
    AdaptationReport adapt(const AdaptationGoal& goal) override;
};

/// Throws InputError, naming the source by `index` (0-based), if its position is outside `domain`
/// or its metric not positive definite.
void require_valid(const PointSource& source, std::size_t index, const Box& domain);
/// The same for a source of any name: "source 3 (a.csv, line 5)".
void require_valid(const PointSource& source, std::size_t index, const std::string& name,
                   const Box& domain);
/// The same for each source.
void require_valid(const SourceColumns& sources, const Box& domain);
/// Whether it does not.
bool is_valid(const PointSource& source, const Box& domain);
/// Throws InputError: a precision was requested of a structure that has no choice.
[[noreturn]] void refuse_precision();
/// Throws InputError unless there is one metric for each control node.
void require_one_each(std::size_t metrics, std::size_t control_nodes);

}  // namespace controlspace

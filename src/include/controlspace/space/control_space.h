// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// What a structure consists of and what it holds in memory, in bytes that are really allocated
/// (capacities, not sizes). The object itself and the allocator's own overhead are not counted.
struct Footprint {
    std::size_t tree_nodes = 0;       ///< leaves and inner nodes; 0 without a tree
    std::size_t cells = 0;            ///< leaves of a tree, or cells of a grid
    std::size_t control_nodes = 0;    ///< points that carry a metric
    int depth = 0;                    ///< deepest level, that of the root or coarsest cells being 0
    std::size_t bytes_payload = 0;    ///< the metrics
    std::size_t bytes_topology = 0;   ///< tree nodes, or indices: what leads to the metrics
    std::size_t bytes_auxiliary = 0;  ///< what only accelerates, or serves insertion alone
    /// A limitation of what was built, or empty: "512^3; 1024^3 would need 51 GB".
    std::string remark;

    std::size_t bytes_total() const { return bytes_payload + bytes_topology + bytes_auxiliary; }
};

class Cursor;

/// A metric at every point of space: a finished structure, or a field without one. It is read only;
/// structures are made and changed by a ControlSpaceBuilder. Reading is thread-safe.
class ControlSpace {
public:
    virtual ~ControlSpace() = default;

    /// Metrics at `x`, on the calling thread; out.size() == x.size(). A point outside the domain
    /// gets the metric of the domain's nearest point; no coordinate may be NaN. The access time t_a
    /// of the paper is this call's duration divided by x.size().
    virtual void sample(std::span<const Point> x, std::span<Metric> out) const = 0;

    /// The smallest length that the metric at each of `x` requests in any direction, without its
    /// tensor; otherwise as `sample`.
    virtual void sample_lengths(std::span<const Point> x, std::span<double> out) const;

    /// The same at one place, without what only batches need: for meshers, which ask place by
    /// place. Batches are about twice as fast, and a cursor where places follow each other closely.
    virtual Metric metric_at(const Point& x) const;
    virtual double length_at(const Point& x) const;
    virtual std::unique_ptr<Cursor> cursor() const;

    /// Where the metric is defined; a field may have no bounds (Box::everywhere()).
    virtual Box domain() const { return Box::everywhere(); }

    virtual Footprint footprint() const { return {}; }

    /// The cell that answers for `x`, for drawing: a leaf of a tree, a cell of a grid; none where
    /// there are no cells.
    virtual std::optional<Box> cell_at(const Point& x) const;
};

inline Metric sample_at(const ControlSpace& space, const Point& x) { return space.metric_at(x); }

/// Answers for one caller, who asks place by place and mostly near the place before, as meshers do:
///
///     const std::unique_ptr<Cursor> cursor = space.cursor();
///     for (...) size = cursor->length_at(vertex);
///
/// The answers are those of the space, to the bit. K_V and K_oV of isotropic metrics remember the
/// last four leaves, with the lengths at their corners. Where they are adapted to a field, so that
/// leaves are longer than elements, a query along a walk takes 0.5 to 1 times as long as without;
/// where leaves are as short as steps, and at random places, it stops remembering. openvdb-bricks
/// remember the last brick of tensors and of codes. Other trees, and trees of tensors, search as
/// length_at does, which takes no longer than looking at what would be remembered. Keeps a
/// reference to the space, which must outlive it, and is for one thread (otherwise: ThreadCursor).
class Cursor {
public:
    virtual ~Cursor() = default;

    virtual Metric metric_at(const Point& x) = 0;
    virtual double length_at(const Point& x);
};

/// A cursor in each thread that asks, for callbacks that a mesher's threads share: thread-safe as
/// the space is. Copies are one and the same. Each thread keeps those that it used last, four of
/// them. Keeps a reference to the space.
class ThreadCursor {
public:
    explicit ThreadCursor(const ControlSpace& space);

    Metric metric_at(const Point& x) const { return own().metric_at(x); }
    double length_at(const Point& x) const { return own().length_at(x); }

private:
    Cursor& own() const;

    const ControlSpace* space_;
    std::uint64_t number_;  // among all ever made: spaces may come to lie where others lay
};

}  // namespace controlspace

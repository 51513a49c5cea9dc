#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "geometry/box.h"
#include "metric/intersection.h"
#include "spaces/source_table.h"

namespace controlspace {

/// The sources that govern a leaf: the field in it is the intersection of their cones. Filled from
/// the front; at most three.
class Anchors {
public:
    static constexpr std::size_t most = 3;

    std::size_t size() const {
        std::size_t n = 0;
        while (n < most && sources_[n] != nobody) ++n;
        return n;
    }
    bool contains(SourceIndex source) const {
        return sources_[0] == source || sources_[1] == source || sources_[2] == source;
    }
    SourceIndex operator[](std::size_t i) const { return sources_[i]; }
    SourceIndex& operator[](std::size_t i) { return sources_[i]; }
    std::span<const SourceIndex> span() const { return {sources_.data(), size()}; }

    /// There must be room.
    void add(SourceIndex source) { sources_[size()] = source; }
    bool operator==(const Anchors&) const = default;

private:
    static constexpr SourceIndex nobody = ~SourceIndex{0};
    std::array<SourceIndex, most> sources_{nobody, nobody, nobody};
};

// Isotropic metrics by their size alone, under the names that metrics have.
inline double intersection(double a, double b) { return std::min(a, b); }
inline double mean_length(double h) { return h; }
inline Metric as_metric(double h) { return Metric::isotropic(h); }
inline const Metric& as_metric(const Metric& m) { return m; }

/// The field of sources of a table: the intersection of their cones and of M_max.
/// `Size` is what a cone is made of: Metric, or double where all metrics are isotropic.
template <class Size>
class ConeIntersection {
public:
    ConeIntersection(const SourceTable& sources, double g, const Size& largest)
        : sources_(sources), g_(g), largest_(largest) {}

    Size at(const Point& x, std::span<const SourceIndex> anchors) const {
        Size size = largest_;
        for (const SourceIndex s : anchors) size = intersection(size, cone(s, x));
        return size;
    }
    Size cone(SourceIndex source, const Point& x) const {
        if constexpr (std::is_same_v<Size, double>) {
            return sources_.metric(source).xx + (g_ - 1) * (x - sources_.position(source)).norm();
        } else {
            return sources_.cone(source, g_, x);
        }
    }

    /// Whether `newcomer` may matter anywhere in `box`, where the field is `here` at its centre and
    /// comes from sources of the table.
    bool may_matter(SourceIndex newcomer, const Box& box, const Size& here) const;

    /// Anchors for the leaf `box` out of `current` and a newcomer: other ones only if they make the
    /// field smaller at the leaf's centre, or as small there and smaller over the leaf's corners.
    ///
    /// What governs the centre always stays. So for isotropic sources, once no leaf gains from any
    /// anchor of its neighbours, the field at the centres keeps the cone law between neighbours.
    Anchors improved(const Anchors& current, SourceIndex newcomer, const Box& box) const;

private:
    const SourceTable& sources_;
    double g_;
    Size largest_;
};

extern template class ConeIntersection<double>;
extern template class ConeIntersection<Metric>;

}  // namespace controlspace

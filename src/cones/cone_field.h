// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "cones/anisotropic_cones.h"
#include "cones/isotropic_cones.h"
#include "cones/order_free_cones.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"

namespace controlspace {

/// The exact field: at p, the intersection of `largest` with the cones
/// M_i (1 + (g_i-1) |M_i^-1 (p - Q_i)|) of all sources i, g_i their own ratios or the field's, g.
///
/// Order-free, it is the largest metric within all of them. In turn (paper §5.2), the result
/// depends on the order, which is part of the definition: cones are taken by their smallest length
/// at p, ascending, and by index where equal. A cone that the metric reached so far is within
/// changes nothing. Of isotropic sources the two are the same, to the bit.
class ConeField {
public:
    /// Positions must be finite, metrics positive definite, g >= 1. Builds on all of TBB's threads.
    ///
    /// Order-free, with a `tolerance` t: the answer is within all cones, and log det M within
    /// 3 ln(1 + t) of the best; t is 1e-7 at least. Throws InputError for anisotropies that
    /// `order_free_intersection` does not accept.
    ///
    /// In turn, a cone is passed over where it would shorten no length of the metric reached so far
    /// by more than the fraction t. The answer is then longer than no cone by more
    /// than this factor, but other cones may be met on the way, so it may differ a little more from
    /// the exact one. 0, exact, by default; without effect on isotropic sources. On spheres of
    /// layered sources (anisotropies of 4 and 50, 36186 and 895534 sources, 60 to 2000 random
    /// places, t from 1e-6 to 1e-2) the non-conformity to the exact field was at most 2.3 t^2; 1e-3
    /// takes 60 % of the time, 1e-2 half.
    ///
    /// Isotropic sources that are many and lie nearly on each other's cones may be thinned out:
    /// lengths are then `longer() <= longer` times the exact ones at most (IsotropicCones).
    template <class Sources>  // PointSources in a row, or SourceColumns
    ConeField(const Sources& sources, double g, const Metric& largest, double tolerance = 0,
              IntersectionRule rule = IntersectionRule::order_free, double longer = 1)
        : largest_(largest),
          longest_(eigen_frame(largest).lengths[2]),
          tolerance_(tolerance),
          rule_(rule),
          cones_(make_cones(sources, g, longer)) {}

    /// What a search remembers from one call to the next: best kept from place to nearby place,
    /// by one thread for one field.
    struct Memory {
        IsotropicCones::Hint hint = 0;
        AnisotropicCones::Search search;
        OrderFreeCones::Search order_free;
    };

    /// Metrics at `x`, intersected with `further` metrics, one for each place or none. On the
    /// calling thread; thread-safe.
    void evaluate(std::span<const Point> x, std::span<Metric> out,
                  std::span<const Metric> further = {}) const;
    /// The same of an isotropic field: the lengths of these metrics, to the bit.
    void evaluate_lengths(std::span<const Point> x, std::span<double> lengths) const;
    /// The same for places that come in an order in which neighbours are near to each other.
    void evaluate(std::span<const Point> x, std::span<Metric> out, Memory& memory,
                  std::span<const Metric> further = {}) const;
    /// The metric at one place, intersected with `further`, if given. Where `has_starts`, the
    /// search begins at `near`, if given, `found` becomes what those of nearby places may begin at,
    /// and a `tolerance`, if given, takes the place of the field's own.
    Metric evaluate(const Point& x, const Metric* further, Memory& memory,
                    const OrderFreeCones::Start* near, OrderFreeCones::Start& found,
                    std::optional<double> tolerance = {}) const;
    /// The same of sources close to those of `near` alone: the volume of an element is no less, but
    /// for the tolerance.
    Metric evaluate_close(const Point& x, const Metric* further, const OrderFreeCones::Start& near,
                          OrderFreeCones::Start& found) const;
    /// Where `has_starts`: appends the indices of the sources that an answer found to matter.
    void append_sources(const OrderFreeCones::Start& found,
                        std::vector<std::uint32_t>& sources) const {
        std::get<OrderFreeCones>(cones_).append_sources(found, sources);
    }
    /// Whether sources are intersected without an order.
    bool has_starts() const { return std::holds_alternative<OrderFreeCones>(cones_); }
    /// The metric `m` at `x`, and the `sources` that make it so, their indices: `m` is `largest`
    /// intersected with their cones. In turn, they come in the order of the definition, and cones
    /// that would shorten no length by more than the fraction `tolerance` are passed over, whatever
    /// the field's own. Isotropic sources: the one whose cone is the smallest, any of several.
    /// Empty where `largest` stands. Costs as much as `evaluate` at one place. Thread-safe.
    void governing(const Point& x, double tolerance, std::vector<std::uint32_t>& sources, Metric& m,
                   Memory& memory) const;

    /// Whether all sources, and `largest`, are isotropic.
    bool is_isotropic() const;
    /// What finds the cones of sources that are all isotropic.
    const IsotropicCones& isotropic() const { return std::get<IsotropicCones>(cones_); }
    /// Sources that were left out because others lie below them everywhere.
    std::size_t dropped() const;
    /// How many times the exact lengths are at most: that of the constructor, or 1.
    double longer() const;

    /// Bytes allocated: of the metrics kept, and of what finds them.
    std::size_t bytes_payload() const;
    std::size_t bytes_topology() const;

private:
    using Cones = std::variant<IsotropicCones, AnisotropicCones, OrderFreeCones>;
    Metric at(const Point& x, const Metric* further, Memory& memory) const;
    Cones make_cones(std::span<const PointSource> sources, double g, double longer) const;
    Cones make_cones(const SourceColumns& sources, double g, double longer) const;

    Metric largest_;
    double longest_;  ///< of the lengths of `largest_`
    double tolerance_;
    IntersectionRule rule_;
    Cones cones_;
};

}  // namespace controlspace

#include "trees/values/anchored_values.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cones/cone_field.h"
#include "cones/order_free_cones.h"
#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/metric/order_free_intersection.h"
#include "controlspace/trees/detail/in_parallel.h"
#include "metric/decompose.h"
#include "metric/interior_point.h"

namespace controlspace {

namespace {

// Shortening all lengths by a small fraction t gives δ = √3 t^2: a cone may be left out where it
// shortens some by this, and most of the target remains for places in between.
double negligible_shortening(double target) { return 0.5 * std::sqrt(target); }

}  // namespace

AnchoredValues::AnchoredValues(const SpaceOptions& options)
    : largest_(largest_metric(options)),
      ratio_(options.ratio),
      intersection_(options.intersection) {}

Metric AnchoredValues::cones_at(const Point& x, std::span<const SourceIndex> anchors) const {
    if (sources_.all_isotropic()) {
        double h = largest_.xx;
        const auto shorten = [&](SourceIndex s, double slope) {
            h = std::min(h, sources_.metric(s).xx + slope * (x - sources_.position(s)).norm());
        };
        if (sources_.all_grow_alike()) {
            for (const SourceIndex s : anchors) shorten(s, ratio_ - 1);
        } else {
            for (const SourceIndex s : anchors) shorten(s, sources_.growth(s, ratio_) - 1);
        }
        return Metric::isotropic(h);
    }
    return are_order_free() ? largest_within_cones(x, anchors, nullptr) : cones_in_turn(x, anchors);
}

Metric AnchoredValues::largest_within_cones(const Point& x, std::span<const SourceIndex> anchors,
                                            const Metric* further) const {
    std::array<Metric, InteriorPoint::room> few;
    std::vector<Metric> many;
    if (anchors.size() + 2 > few.size()) many.resize(anchors.size() + 2);
    const std::span<Metric> cones = many.empty() ? std::span<Metric>(few) : many;
    std::size_t n = 0;
    cones[n++] = largest_;
    if (further != nullptr) cones[n++] = *further;
    for (const SourceIndex s : anchors) {
        cones[n++] = sources_.factor(s, ratio_, x) * sources_.metric(s);
    }
    // All of few at once: a search for those that matter would take longer.
    if (many.empty() && n > 2) {
        InteriorPoint solution(cones.first(n));
        solution.solve(gap_);
        if (std::abs(solution.gap()) <= gap_) return left_polar_factor(solution.factor());
    }
    return order_free_intersection(cones.first(n), gap_).metric();
}

// Cones of tensors by their smallest lengths at the place, as in the exact field.
Metric AnchoredValues::cones_in_turn(const Point& x, std::span<const SourceIndex> anchors) const {
    struct Cone {
        double smallest, factor;
        SourceIndex source;
    };
    std::array<Cone, most> cones;
    std::size_t n = 0;
    for (const SourceIndex s : anchors.first(std::min(anchors.size(), most))) {
        const double factor = sources_.factor(s, ratio_, x);
        const Cone cone{factor * sources_.smallest_length(s), factor, s};
        std::size_t i = n++;
        for (; i > 0 && cone.smallest < cones[i - 1].smallest; --i) cones[i] = cones[i - 1];
        cones[i] = cone;
    }
    Metric m = largest_;
    for (std::size_t i = 0; i < n; ++i) {
        m = intersection(m, cones[i].factor * sources_.metric(cones[i].source));
    }
    for (const SourceIndex s : anchors.subspan(n)) {
        m = intersection(m, sources_.factor(s, ratio_, x) * sources_.metric(s));
    }
    return m;
}

Metric AnchoredValues::value(const Box& domain, LeafIndex leaf, const Point& place) const {
    const Point x = nearest_in(domain, place);
    const auto anchors = anchors_.of(leaf);
    if (!continuous_) return cones_at(x, anchors);
    const Metric further = sample_at(*continuous_, x);
    if (are_order_free()) {
        return largest_within_cones(x, anchors, &further);
    }
    return intersection(cones_at(x, anchors), further);
}

void AnchoredValues::split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
    anchors_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
}

void AnchoredValues::add(LeafIndex leaf, const PointSource& source) {
    anchors_.add(leaf, sources_.add(source));
}

void AnchoredValues::take_over(const AdaptationGoal& goal) {
    ratio_ = goal.ratio;
    intersection_ = goal.intersection;
    gap_ = OrderFreeCones::gap_of(std::min(0.1 * goal.target, 0.1));  // as the goal's field
    continuous_ = goal.continuous;
    largest_ = Metric::isotropic(std::min(largest_.xx, goal.h_max));
    sources_ = {};
    for (const PointSource& source : goal.sources) sources_.add(source);
}

bool AnchoredValues::is_covered(SourceIndex source, std::span<const SourceIndex> others,
                                const Box& box, int halvings) const {
    const Metric& own = sources_.metric(source);
    const Point& q = sources_.position(source);
    const auto largest_factor = [&](SourceIndex s) {
        double factor = 1;
        for (int i = 0; i < 8; ++i) {
            factor = std::max(factor, sources_.factor(s, ratio_, corner(box, i)));
        }
        return factor;
    };
    double least = 0;  // of the factor, in the box
    if (is_isotropic(own)) {
        least = sources_.factor(source, ratio_, nearest_in(box, q));
    } else {
        double reach = 0;
        for (int i = 0; i < 8; ++i) {
            reach = std::max(reach, metric_length(own, corner(box, i) - box.centre()));
        }
        const double away = metric_length(own, box.centre() - q) - reach;
        least = 1 + (sources_.growth(source, ratio_) - 1) * std::max(0.0, away);
    }
    const Metric shortest = least * own;
    if (is_within(largest_, 1, shortest)) return true;
    for (const SourceIndex s : others) {
        if (is_within(largest_factor(s) * sources_.metric(s), 1, shortest)) return true;
    }
    if (halvings == 0) return false;
    const Subdivision parts = octants(box);
    for (int c = 0; c < parts.children(); ++c) {
        if (!is_covered(source, others, parts.child(c), halvings - 1)) return false;
    }
    return true;
}

std::size_t AnchoredValues::drop_needless(std::span<SourceIndex> list, std::span<const Point> x,
                                          std::span<const Metric> exact, double tolerance) const {
    std::size_t n = list.size();
    const auto left_by = [&](std::span<const SourceIndex> sources, std::size_t i) {
        return std::max(tolerance, nonconformity(cones_at(x[i], sources), exact[i]));
    };
    std::array<double, LeafPlaces::all> left{};  // by the list as it is
    std::array<double, LeafPlaces::all> left_without{};
    for (std::size_t i = 0; i < x.size(); ++i) left[i] = left_by(list, i);
    for (std::size_t k = 0; k < n;) {
        std::array<SourceIndex, most> others{};
        std::copy_n(list.begin(), k, others.begin());
        std::copy(list.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                  list.begin() + static_cast<std::ptrdiff_t>(n),
                  others.begin() + static_cast<std::ptrdiff_t>(k));
        const auto without = std::span<const SourceIndex>(others).first(n - 1);
        bool is_needed = false;
        for (std::size_t i = 0; i < x.size() && !is_needed; ++i) {
            left_without[i] = left_by(without, i);
            is_needed = left_without[i] > left[i];
        }
        if (is_needed) {
            ++k;
        } else {
            std::ranges::copy(without, list.begin());
            left = left_without;
            --n;
        }
    }
    return n;
}

void AnchoredValues::fit(std::span<const LeafBox> leaves, const GoalField& field,
                         std::size_t places, bool beside_old) {
    const double well_within = 0.25 * field.target();
    const double negligible = negligible_shortening(field.target());
    const double factor = largest_factor_within(well_within);
    std::vector<SourceIndex> chosen(leaves.size() * most);
    std::vector<std::size_t> count(leaves.size(), 0);
    // Cells of an order-free search serve many leaves, and have no effect on answers.
    tbb::enumerable_thread_specific<ConeField::Memory> memories;
    in_parallel(leaves.size(), [&, governing = std::vector<SourceIndex>()](std::size_t i) mutable {
        ConeField::Memory& memory = memories.local();
        const std::span<SourceIndex> list(chosen.data() + i * most, most);
        std::size_t& n = count[i];
        memory.hint = 0;  // of several sources that are equally near the same is found always
        std::array<Point, LeafPlaces::all> at;
        std::array<Metric, LeafPlaces::all> exact;
        for (std::size_t k = 0; k < places; ++k) {
            const std::size_t p = (LeafPlaces::centre + k) % LeafPlaces::all;  // the centre first
            const Point x = leaf_places().in(leaves[i].box, p);
            const Metric own = cones_at(x, list.first(n));
            if (field.cones().is_isotropic()) {
                const auto below =
                    field.cones().isotropic().source_below(x, own.xx / factor, memory.hint);
                if (below && n < most) list[n++] = *below;
                continue;
            }
            Metric m;
            field.cones().governing(x, negligible, governing, m, memory);
            at[k] = x;
            exact[k] = m;
            if (nonconformity(own, m) <= well_within) continue;
            for (const SourceIndex s : governing) {
                const auto end = list.begin() + static_cast<std::ptrdiff_t>(n);
                if (n < most_anchors() && std::find(list.begin(), end, s) == end) list[n++] = s;
            }
        }
        if (are_order_free() && places == LeafPlaces::all) {
            n = drop_needless(list.first(n), std::span(at).first(places), exact, well_within);
        }
    });
    std::vector<std::vector<SourceIndex>> kept(beside_old ? leaves.size() : 0);
    in_parallel(kept.size(), [&](std::size_t i) {
        const auto fitted = std::span<const SourceIndex>(chosen).subspan(i * most, count[i]);
        constexpr int halvings = 2;
        for (const SourceIndex s : anchors_.of(leaves[i].leaf)) {
            if (std::ranges::find(fitted, s) == fitted.end() &&
                !is_covered(s, fitted, leaves[i].box, halvings)) {
                kept[i].push_back(s);
            }
        }
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const auto fitted = std::span<const SourceIndex>(chosen).subspan(i * most, count[i]);
        if (kept.empty() || kept[i].empty()) {
            anchors_.set(leaves[i].leaf, fitted);
        } else {
            kept[i].insert(kept[i].end(), fitted.begin(), fitted.end());
            anchors_.set(leaves[i].leaf, kept[i]);
        }
    }
}

void AnchoredValues::cover(std::span<const LeafBox> leaves, const GoalField& field,
                           std::span<std::uint8_t> is_kept) {
    const double tolerance = largest_factor_within(field.target()) - 1;
    std::vector<SourceIndex> chosen(leaves.size() * most);
    std::vector<std::size_t> count(leaves.size());
    in_parallel(leaves.size(), [&, memory = ConeField::Memory(),
                                cover = ConeCover()](std::size_t i) mutable {
        memory.hint = 0;  // of several sources that are equally near the same is found always
        is_kept[i] =
            field.cones().isotropic().cover(leaves[i].box, tolerance, cover, memory.hint) ? 1 : 0;
        const auto sources = cover.sources();
        std::ranges::copy(sources, chosen.begin() + static_cast<std::ptrdiff_t>(i * most));
        count[i] = sources.size();
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        anchors_.set(leaves[i].leaf, std::span(chosen).subspan(i * most, count[i]));
    }
}

bool AnchoredValues::learn(LeafIndex leaf, const Point& x, const GoalField& field) {
    std::vector<SourceIndex> governing;
    Metric m;
    field.cones().governing(x, negligible_shortening(field.target()), governing, m);
    const auto old = anchors_.of(leaf);
    std::vector<SourceIndex> list(old.begin(), old.end());
    for (const SourceIndex s : governing) {
        if (std::find(list.begin(), list.end(), s) == list.end()) list.push_back(s);
    }
    if (list.size() == old.size() || list.size() > most_anchors()) return false;
    anchors_.set(leaf, list);
    return true;
}

void AnchoredValues::drop_idle_sources() {
    anchors_.shrink_to_fit();
    anchors_.rename(sources_.keep(anchors_.used(sources_.size())));
}

void AnchoredValues::save(StateWriter& state) const {
    if (continuous_) {
        throw InputError(
            "a tree that keeps a continuous field cannot be saved: save one that holds metrics");
    }
    sources_.save(state);
    anchors_.save(state);
    state("anchors.ratio", ratio_);
    state("anchors.largest", largest_.xx);
    state("anchors.intersection", intersection_, IntersectionRule::in_turn);
    state("anchors.fits_tensors_loosely", fits_tensors_loosely_);
    state("anchors.gap", gap_);
}

void AnchoredValues::load(std::size_t leaves, const StateReader& state) {
    sources_.load(state);
    anchors_.load(state, leaves, sources_.size());
    state("anchors.ratio", ratio_);
    state.require(ratio_ >= 1 && ratio_ <= largest_magnitude, "anchors.ratio",
                  "is no gradation ratio");
    double largest = 0;
    state("anchors.largest", largest);
    state.require(is_length(largest), "anchors.largest", "is no length");
    largest_ = Metric::isotropic(largest);
    state("anchors.intersection", intersection_, IntersectionRule::in_turn);
    state("anchors.fits_tensors_loosely", fits_tensors_loosely_);
    state("anchors.gap", gap_);
    state.require(gap_ >= 1e-10 && gap_ <= 1, "anchors.gap", "is out of range");
}

void AnchoredValues::describe(Footprint& footprint) const {
    footprint.control_nodes = anchors_.leaves();
    footprint.bytes_payload = anchors_.bytes() + sources_.bytes();
}

void AnchoredValues::shrink_to_fit() {
    anchors_.shrink_to_fit();
    sources_.shrink_to_fit();
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/nearby_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "cones/cone_field.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "space/goal_cache.h"
#include "trees/adaptation/leaf_places.h"
#include "trees/in_parallel.h"

namespace controlspace {

// The field at the places of one box. Of lengths, the cones that matter in the box are gathered
// once, if they are few, and each place compares them; otherwise a search starts from the source
// that was found last. Of tensors without an order, each place is an optimization: it starts from
// the solution at the nearest place, in that one's own metric, and is rough where there are many
// sources: first with the sources alone that mattered there. Sources that it misses would make the
// field shorter; every 16th place searches all, and where it finds such, the next 16 do. So a rough
// value is an estimate, and whoever compares it evaluates anew what may be above the target. Places
// that cells share are evaluated once, with all sources (GoalCache).

namespace {

// Answers at places of a leaf, from which those at other places of it start.
class Trail {
public:
    void clear() { steps_.clear(); }
    void add(const Point& x, const OrderFreeCones::Start& start) {
        constexpr std::size_t most = 64;
        if (start.count == 0 || steps_.size() == most) return;
        steps_.push_back({x, start.factor.inverse(), start});
    }
    /// That at the nearest place, as its own metric measures; null if there is none.
    const OrderFreeCones::Start* nearest(const Point& x) const {
        const OrderFreeCones::Start* nearest = nullptr;
        double least = std::numeric_limits<double>::infinity();
        for (const Step& step : steps_) {
            const double distance = (step.inverse_factor * (x - step.place)).squaredNorm();
            if (!(distance < least)) continue;
            least = distance;
            nearest = &step.start;
        }
        return nearest;
    }

private:
    struct Step {
        Point place;
        Eigen::Matrix3d inverse_factor;
        OrderFreeCones::Start start;
    };
    std::vector<Step> steps_;
};

}  // namespace

struct NearbyField::Search {
    explicit Search(const GoalField& of) : field(of) {
        if (takes_long()) memory.order_free = field.cache().borrow();
    }
    Search(const Search& other) : Search(other.field) {}
    ~Search() {
        if (takes_long()) field.cache().give_back(std::move(memory.order_free));
    }
    Search& operator=(const Search&) = delete;

    const GoalField& field;
    Box box = {};
    Trail trail = {};
    ConeField::Memory memory = {};
    ConeList cones = {};  // of the box, if they are few
    bool is_gathered = false;
    bool are_few = false;
    std::size_t until_check = 0;  // places of the box at which close cones will do
    std::size_t until_close = 0;  // places of the box at which they will not
    std::vector<std::pair<Point, OrderFreeCones::Start>> close = {};  // of the last places

    bool takes_long() const { return !field.cones().is_isotropic(); }
    void gather() {
        if (is_gathered) return;
        is_gathered = true;
        are_few = !takes_long() && field.cones().isotropic().gather(box, cones, memory.hint);
    }
    void by_memory(std::span<const Point> x, std::span<Metric> out) {
        const std::vector<Metric> continuous = field.continuous_at(x);
        if (!field.cones().has_starts()) {
            field.cones().evaluate(x, out, memory, continuous);
            return;
        }
        const double tolerance = std::min(0.01 * field.target(), 0.1);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Metric* continuous_here = continuous.empty() ? nullptr : &continuous[i];
            const auto known = std::ranges::find(close, x[i], &decltype(close)::value_type::first);
            const auto* near = known != close.end() ? &known->second : trail.nearest(x[i]);
            out[i] = answer(x[i], continuous_here, near, tolerance).metric;
        }
    }
    // A search of all sources takes most of the time, and where the field is known at some places
    // of a box it rarely finds more than one close to their sources does. So such searches are made
    // at the first of every few places, and, where one of them finds more, at the few that follow.
    void by_close_cones(std::span<const Point> x, std::span<Metric> out) {
        constexpr std::size_t few = 16;
        const std::vector<Metric> continuous = field.continuous_at(x);
        close.clear();
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Metric* continuous_here = continuous.empty() ? nullptr : &continuous[i];
            const OrderFreeCones::Start* near = trail.nearest(x[i]);
            if (near == nullptr || until_close > 0) {
                out[i] = answer(x[i], continuous_here, near).metric;
                if (until_close > 0) --until_close;
                continue;
            }
            OrderFreeCones::Start& start = close.emplace_back(x[i], *near).second;
            out[i] = field.cones().evaluate_close(x[i], continuous_here, *near, start);
            if (until_check-- > 0) continue;
            until_check = few - 1;
            const Metric found = out[i];
            out[i] = answer(x[i], continuous_here, &start).metric;
            if (nonconformity(out[i], found) < 0.1 * field.target()) continue;
            until_close = few;
            until_check = 0;
        }
    }
    GoalCache::Answer answer(const Point& x, const Metric* continuous,
                             const OrderFreeCones::Start* near,
                             std::optional<double> tolerance = {}) {
        GoalCache::Answer answer;
        answer.metric =
            field.cones().evaluate(x, continuous, memory, near, answer.start, tolerance);
        trail.add(x, answer.start);
        return answer;
    }
    GoalCache::Answer answer_near(const Point& x) {
        const std::vector<Metric> continuous = field.continuous_at({&x, 1});
        return answer(x, continuous.empty() ? nullptr : continuous.data(), trail.nearest(x));
    }
    std::optional<GoalCache::Answer> recall(const Point& x) {
        GoalCache::Answer known;
        if (!field.cache().recall(x, known)) return std::nullopt;
        trail.add(x, known.start);
        return known;
    }
    // Whatever the places before.
    Metric shared(const Point& x) {
        if (const auto known = recall(x)) return known->metric;
        GoalCache::Answer known;
        const std::vector<Metric> continuous = field.continuous_at({&x, 1});
        known = answer(x, continuous.empty() ? nullptr : continuous.data(), nullptr);
        field.cache().remember(x, known);
        return known.metric;
    }
    void by_few(std::span<const Point> x, std::span<Metric> out) const {
        const std::vector<Metric> continuous = field.continuous_at(x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = Metric::isotropic(cones.smallest_length(x[i], field.largest().xx));
            if (!continuous.empty()) out[i] = intersection(out[i], continuous[i]);
        }
    }
};

NearbyField::NearbyField(const GoalField& field) : search_(new Search(field)) {}
NearbyField::NearbyField(const NearbyField& other) : search_(new Search(*other.search_)) {}
NearbyField::~NearbyField() = default;

void NearbyField::enter(const Box& box, bool at_many_points) {
    search_->box = box;
    search_->memory.hint = 0;
    search_->trail.clear();
    search_->close.clear();
    search_->is_gathered = !at_many_points;
    search_->are_few = false;
    search_->until_check = 0;
    search_->until_close = 0;
}

void NearbyField::evaluate(std::span<const Point> x, std::span<Metric> out) {
    search_->gather();
    if (search_->are_few) {
        search_->by_few(x, out);
    } else {
        search_->by_memory(x, out);
    }
}

NearbyField::Accuracy NearbyField::evaluate_roughly(std::span<const Point> x, Cones cones,
                                                    std::span<Metric> out) {
    using Kind = Accuracy::Kind;
    const GoalField& field = search_->field;
    const bool is_rough = field.is_order_free() && !field.has_few_sources();
    if (cones == Cones::shared && search_->takes_long()) {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = at(x[i]);
        return {is_rough ? Kind::estimate : Kind::exact};
    }
    if (is_rough) {
        if (cones == Cones::all) {
            for (std::size_t i = 0; i < x.size(); ++i) out[i] = search_->answer_near(x[i]).metric;
        } else {
            search_->by_close_cones(x, out);
        }
        return {Kind::estimate};
    }
    search_->gather();
    if (search_->are_few || !field.has_ranges()) {
        evaluate(x, out);
        return {};
    }
    const double tolerance = field.negligible();
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = Metric::isotropic(
            field.cones().isotropic().smallest_length(x[i], search_->memory.hint, tolerance));
    }
    return {Kind::at_most_longer, 1 + tolerance};
}

Metric NearbyField::governed(const Point& x, double tolerance,
                             std::vector<std::uint32_t>& sources) {
    const GoalField& field = search_->field;
    if (!field.cones().has_starts()) {
        Metric m;
        field.cones().governing(x, tolerance, sources, m, search_->memory);
        return m;
    }
    sources.clear();
    const auto known = search_->recall(x);
    const GoalCache::Answer answer = known ? *known : search_->answer_near(x);
    field.cones().append_sources(answer.start, sources);
    return answer.metric;
}

Metric NearbyField::at(const Point& x) {
    if (search_->takes_long()) return search_->shared(x);
    Metric m;
    search_->by_memory({&x, 1}, {&m, 1});
    return m;
}

std::optional<NearbyField::Doubt> NearbyField::doubt_of(const std::array<double, 8>& at_corners) {
    const GoalField& field = search_->field;
    const auto doubt = field.cones().isotropic().doubt_of(
        {search_->box, at_corners}, largest_factor_within(field.target()), search_->memory.hint);
    if (!doubt) return std::nullopt;
    return Doubt{doubt->where, doubt->is_certain};
}

void evaluate_shared(const GoalField& field, std::span<const CellBox> leaves, std::size_t from,
                     std::size_t to) {
    if (!field.cones().has_starts()) return;
    struct Query {
        std::array<double, 3> place;
        std::size_t leaf;
    };
    std::vector<Query> queries;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        constexpr std::size_t most_sharing = 8;
        if (!field.cache().has_room_for(queries.size() / most_sharing)) return;
        for (std::size_t k = from; k < to; ++k) {
            const Point x = leaf_places().in(leaves[i].box, k);
            if (!field.cache().has(x)) queries.push_back({{x.x(), x.y(), x.z()}, i});
        }
    }
    std::ranges::sort(queries, {},
                      [](const Query& query) { return std::tie(query.place, query.leaf); });
    const auto repeated = std::ranges::unique(queries, {}, &Query::place);
    queries.erase(repeated.begin(), repeated.end());
    if (!field.cache().has_room_for(queries.size())) return;
    std::ranges::stable_sort(queries, {}, &Query::leaf);
    std::vector<std::span<const Query>> of_leaves;
    for (auto first = queries.cbegin(); first != queries.cend();) {
        const auto end = std::find_if(
            first, queries.cend(), [&](const Query& query) { return query.leaf != first->leaf; });
        of_leaves.emplace_back(first, end);
        first = end;
    }
    // They become known together, so that none starts from what another thread happens to have.
    std::vector<GoalCache::Answer> answers(queries.size());
    in_parallel(of_leaves.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        const std::span<const Query> of_leaf = of_leaves[i];
        const Box& box = leaves[of_leaf.front().leaf].box;
        NearbyField::Search& search = *nearby.search_;
        nearby.enter(box, true);
        for (std::size_t k = LeafPlaces::corners; k < LeafPlaces::centre; ++k) {
            search.recall(leaf_places().in(box, k));
        }
        for (const Query& query : of_leaf) {
            const Point x(query.place[0], query.place[1], query.place[2]);
            answers[static_cast<std::size_t>(&query - queries.data())] = search.answer_near(x);
        }
    });
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto& [x, y, z] = queries[i].place;
        field.cache().remember({x, y, z}, answers[i]);
    }
}

NearbyField::Range NearbyField::range() {
    const auto [least, most] =
        search_->field.cones().isotropic().range_in(search_->box, search_->memory.hint);
    return {least, most};
}

}  // namespace controlspace

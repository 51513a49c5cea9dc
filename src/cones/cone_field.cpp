// SPDX-License-Identifier: Apache-2.0
#include "cones/cone_field.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "cones/spatial_order.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

ConeField::Cones ConeField::make_cones(std::span<const PointSource> sources, double g,
                                       double longer) const {
    if (all_isotropic(sources)) return IsotropicCones(columns_of(sources), g, longest_, longer);
    if (rule_ == IntersectionRule::in_turn) return AnisotropicCones(sources, g, longest_);
    return OrderFreeCones(sources, g, largest_, tolerance_);
}

ConeField::Cones ConeField::make_cones(const SourceColumns& sources, double g,
                                       double longer) const {
    if (sources.are_isotropic()) return IsotropicCones(sources, g, longest_, longer);
    return make_cones(sources.all(), g, longer);
}

Metric ConeField::at(const Point& x, const Metric* further, Memory& memory) const {
    if (const auto* cones = std::get_if<OrderFreeCones>(&cones_)) {
        return cones->intersect(x, further, memory.order_free).metric();
    }
    Metric m = largest_;
    if (const auto* isotropic = std::get_if<IsotropicCones>(&cones_)) {
        const Metric cone = Metric::isotropic(isotropic->smallest_length(x, memory.hint));
        const bool are_three = further != nullptr && !controlspace::is_isotropic(largest_);
        if (are_three && rule_ == IntersectionRule::order_free) {
            const std::array<Metric, 3> all{largest_, cone, *further};
            return order_free_intersection(all, OrderFreeCones::gap_of(tolerance_)).metric();
        }
        if (cone.xx < longest_) m = intersection(largest_, cone);
    } else {
        m = std::get<AnisotropicCones>(cones_).intersect(x, largest_, tolerance_, memory.search,
                                                         nullptr);
    }
    return further != nullptr ? intersection(m, *further) : m;
}

Metric ConeField::evaluate(const Point& x, const Metric* further, Memory& memory,
                           const OrderFreeCones::Start* near, OrderFreeCones::Start& found,
                           std::optional<double> tolerance) const {
    const auto* cones = std::get_if<OrderFreeCones>(&cones_);
    if (cones == nullptr) return at(x, further, memory);
    return cones->intersect(x, further, memory.order_free, near, &found, tolerance).metric();
}

Metric ConeField::evaluate_close(const Point& x, const Metric* further,
                                 const OrderFreeCones::Start& near,
                                 OrderFreeCones::Start& found) const {
    return std::get<OrderFreeCones>(cones_).intersect_close(x, further, near, found).metric();
}

void ConeField::evaluate(std::span<const Point> x, std::span<Metric> out,
                         std::span<const Metric> further) const {
    assert(x.size() == out.size());
    Memory memory;
    if (std::holds_alternative<AnisotropicCones>(cones_)) return evaluate(x, out, memory, further);
    if (further.empty() && is_isotropic()) {
        std::vector<double> lengths(x.size());
        evaluate_lengths(x, lengths);
        std::transform(lengths.begin(), lengths.end(), out.begin(), Metric::isotropic);
        return;
    }
    // Near the last place the hint is good, and the sources are in the caches.
    for (const std::uint32_t i : spatial_order(x)) {
        out[i] = at(x[i], further.empty() ? nullptr : &further[i], memory);
    }
}

void ConeField::evaluate_lengths(std::span<const Point> x, std::span<double> lengths) const {
    const std::vector<std::uint32_t> order = spatial_order(x);
    std::vector<Point> places(x.size());
    std::vector<double> found(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) places[i] = x[order[i]];
    IsotropicCones::Hint hint = 0;
    isotropic().smallest_lengths(places, found, hint);
    for (std::size_t i = 0; i < x.size(); ++i) lengths[order[i]] = found[i];
}

void ConeField::evaluate(std::span<const Point> x, std::span<Metric> out, Memory& memory,
                         std::span<const Metric> further) const {
    assert(x.size() == out.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = at(x[i], further.empty() ? nullptr : &further[i], memory);
    }
}

void ConeField::governing(const Point& x, double tolerance, std::vector<std::uint32_t>& sources,
                          Metric& m, Memory& memory) const {
    sources.clear();
    if (const auto* cones = std::get_if<OrderFreeCones>(&cones_)) {
        const OrderFreeIntersection answer = cones->intersect(x, nullptr, memory.order_free);
        m = answer.metric();
        constexpr double counts = 1e-3;  // all traces together are 3
        for (const auto& [index, tensor] : answer.multipliers()) {
            if (index == OrderFreeCones::index_of_largest) continue;
            if (tensor.xx + tensor.yy + tensor.zz > counts) sources.push_back(index);
        }
        return;
    }
    if (const auto* cones = std::get_if<AnisotropicCones>(&cones_)) {
        m = cones->intersect(x, largest_, tolerance, memory.search, &sources);
        return;
    }
    const double h = isotropic().smallest_length(x, memory.hint);
    m = largest_;
    if (h * (1 + tolerance) >= longest_) return;
    m = intersection(largest_, Metric::isotropic(h));
    sources.push_back(isotropic().source_of(x, h, memory.hint));
}

bool ConeField::is_isotropic() const {
    return std::holds_alternative<IsotropicCones>(cones_) && controlspace::is_isotropic(largest_);
}

std::size_t ConeField::dropped() const {
    return std::visit([](const auto& cones) { return cones.dropped(); }, cones_);
}

double ConeField::longer() const {
    const auto* isotropic = std::get_if<IsotropicCones>(&cones_);
    return isotropic != nullptr ? isotropic->longer() : 1;
}

std::size_t ConeField::bytes_payload() const {
    return std::visit([](const auto& cones) { return cones.bytes_payload(); }, cones_);
}

std::size_t ConeField::bytes_topology() const {
    return std::visit([](const auto& cones) { return cones.bytes_topology(); }, cones_);
}

}  // namespace controlspace

#include "cones/cone_field.h"

#include <algorithm>
#include <cassert>

#include "cones/spatial_order.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

ConeField::ConeField(std::span<const PointSource> sources, double g, const Metric& largest,
                     double tolerance)
    : largest_(largest),
      longest_(eigen_frame(largest).lengths[2]),
      tolerance_(tolerance),
      cones_(make_cones(sources, g, largest)) {}

ConeField::Cones ConeField::make_cones(std::span<const PointSource> sources, double g,
                                       const Metric& largest) {
    const bool isotropic = std::all_of(sources.begin(), sources.end(), [](const PointSource& s) {
        return controlspace::is_isotropic(s.metric);
    });
    const double cap = eigen_frame(largest).lengths[2];
    if (isotropic) return IsotropicCones(sources, g, cap);
    return AnisotropicCones(sources, g, cap);
}

Metric ConeField::at(const Point& x, Memory& memory) const {
    if (const auto* isotropic = std::get_if<IsotropicCones>(&cones_)) {
        const double h = isotropic->smallest_length(x, memory.hint);
        return h < longest_ ? intersection(largest_, Metric::isotropic(h)) : largest_;
    }
    return std::get<AnisotropicCones>(cones_).intersect(x, largest_, tolerance_, memory.search,
                                                        nullptr);
}

void ConeField::evaluate(std::span<const Point> x, std::span<Metric> out) const {
    assert(x.size() == out.size());
    Memory memory;
    if (std::holds_alternative<AnisotropicCones>(cones_)) return evaluate(x, out, memory);
    // Near the last place the hint is good, and the sources are in the caches.
    for (const std::uint32_t i : spatial_order(x)) out[i] = at(x[i], memory);
}

void ConeField::evaluate(std::span<const Point> x, std::span<Metric> out, Memory& memory) const {
    assert(x.size() == out.size());
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = at(x[i], memory);
}

void ConeField::governing(const Point& x, double tolerance, std::vector<std::uint32_t>& sources,
                          Metric& m, Memory& memory) const {
    sources.clear();
    const auto* isotropic = std::get_if<IsotropicCones>(&cones_);
    if (isotropic == nullptr) {
        m = std::get<AnisotropicCones>(cones_).intersect(x, largest_, tolerance, memory.search,
                                                         &sources);
        return;
    }
    const double h = isotropic->smallest_length(x, memory.hint);
    m = largest_;
    if (h * (1 + tolerance) >= longest_) return;
    m = intersection(largest_, Metric::isotropic(h));
    sources.push_back(isotropic->source_of(x, h, memory.hint));
}

void ConeField::governing(const Point& x, double tolerance, std::vector<std::uint32_t>& sources,
                          Metric& m) const {
    Memory memory;
    governing(x, tolerance, sources, m, memory);
}

void ConeField::evaluate_roughly(std::span<const Point> x, double tolerance, std::span<Metric> out,
                                 Memory& memory) const {
    const auto& cones = std::get<IsotropicCones>(cones_);
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = Metric::isotropic(cones.smallest_length(x[i], tolerance, memory.hint));
    }
}

bool ConeField::is_isotropic() const {
    return std::holds_alternative<IsotropicCones>(cones_) && controlspace::is_isotropic(largest_);
}

IsotropicCones::Range ConeField::range_in(const Box& box, Memory& memory) const {
    return std::get<IsotropicCones>(cones_).range_in(box, memory.hint);
}

bool ConeField::gather(const Box& box, NearbyCones& nearby, Memory& memory) const {
    const auto* isotropic = std::get_if<IsotropicCones>(&cones_);
    return isotropic != nullptr && isotropic->gather(box, nearby, memory.hint);
}

std::optional<std::uint32_t> ConeField::source_below(const Point& x, double length,
                                                     Memory& memory) const {
    return std::get<IsotropicCones>(cones_).source_below(x, length, memory.hint);
}

bool ConeField::cover(const Box& box, double tolerance, ConeCover& cover, Memory& memory) const {
    return std::get<IsotropicCones>(cones_).cover(box, tolerance, cover, memory.hint);
}

std::size_t ConeField::dropped() const {
    return std::visit([](const auto& cones) { return cones.dropped(); }, cones_);
}

std::size_t ConeField::bytes_payload() const {
    return std::visit([](const auto& cones) { return cones.bytes_payload(); }, cones_);
}

std::size_t ConeField::bytes_topology() const {
    return std::visit([](const auto& cones) { return cones.bytes_topology(); }, cones_);
}

}  // namespace controlspace

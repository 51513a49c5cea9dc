// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/control_space.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "controlspace/gradation/grade.h"
#include "controlspace/space/control_nodes.h"
#include "space/plain_cursor.h"

namespace controlspace {

namespace {

double smallest_length(const Metric& m) {
    return is_isotropic(m) ? m.xx : eigen_frame(m).lengths[0];
}

}  // namespace

void ControlSpace::sample_lengths(std::span<const Point> x, std::span<double> out) const {
    if (x.size() == 1) {  // no array to clear
        out[0] = smallest_length(metric_at(x[0]));
        return;
    }
    std::array<Metric, 128> metrics;
    for (std::size_t first = 0; first < x.size(); first += metrics.size()) {
        const std::size_t n = std::min(metrics.size(), x.size() - first);
        sample(x.subspan(first, n), std::span(metrics).first(n));
        for (std::size_t i = 0; i < n; ++i) out[first + i] = smallest_length(metrics[i]);
    }
}

Metric ControlSpace::metric_at(const Point& x) const {
    Metric m;
    sample({&x, 1}, {&m, 1});
    return m;
}

double ControlSpace::length_at(const Point& x) const { return smallest_length(metric_at(x)); }

std::unique_ptr<Cursor> ControlSpace::cursor() const {
    return std::make_unique<PlainCursor<ControlSpace>>(*this);
}

double Cursor::length_at(const Point& x) { return smallest_length(metric_at(x)); }

ThreadCursor::ThreadCursor(const ControlSpace& space) : space_(&space) {
    static std::atomic<std::uint64_t> made = 0;
    number_ = ++made;
}

Cursor& ThreadCursor::own() const {
    struct Kept {
        std::uint64_t number = 0;  // none
        std::unique_ptr<Cursor> cursor;
    };
    static thread_local std::array<Kept, 4> kept;
    static thread_local std::size_t next = 0;
    for (const Kept& k : kept) {
        if (k.number == number_) return *k.cursor;
    }
    Kept& oldest = kept[next];
    oldest.number = 0;  // should making one fail
    oldest.cursor = space_->cursor();
    oldest.number = number_;
    next = (next + 1) % kept.size();
    return *oldest.cursor;
}

std::optional<Box> ControlSpace::cell_at(const Point&) const { return std::nullopt; }

std::optional<ControlNodes> control_nodes(const ControlSpace& space, Neighbourhood neighbourhood) {
    const auto* nodes = dynamic_cast<const HasControlNodes*>(&space);
    if (nodes == nullptr) return std::nullopt;
    return nodes->control_nodes(neighbourhood);
}

std::optional<double> largest_gradation(const ControlSpace& space, Neighbourhood neighbourhood,
                                        GradationLaw law) {
    const auto* nodes = dynamic_cast<const HasControlNodes*>(&space);
    if (nodes == nullptr) return std::nullopt;
    return nodes->largest_gradation(neighbourhood, law);
}

double HasControlNodes::largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const {
    const ControlNodes nodes = control_nodes(neighbourhood);
    return controlspace::largest_gradation(nodes.graph, nodes.metrics, law);
}

}  // namespace controlspace

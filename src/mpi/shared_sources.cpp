// SPDX-License-Identifier: Apache-2.0
// Which sources matter in which octants, and their exchange.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/shared_sources.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cones/isotropic_cones.h"
#include "geometry/point_order.h"

namespace controlspace {

/// A cone that bounds the field.
struct SharedSources::Bound {
    Point position = Point::Zero();
    double length = std::numeric_limits<double>::infinity(), slope = 0;

    double most_in(const Box& box) const {
        const Vector away = (box.centre() - position).cwiseAbs() + 0.5 * box.edges();
        return length + slope * away.norm();
    }
};

SharedSources::SharedSources(Ranks& ranks, const Octants& octants,
                             const DistributedOptions& options, bool has_tensors, double steepest,
                             std::vector<Record>&& records)
    : ranks_(ranks),
      octants_(octants),
      space_(options.space),
      steepest_(steepest),
      ratio_(options.space.ratio),
      cap_(largest_metric(options.space).xx),
      counts_(options.target || options.structure == "K_oLB" ? Counts::everywhere
              : options.structure == "K_oL"                  ? Counts::at_centres
                                                             : Counts::at_corners),
      has_tensors_(has_tensors),
      records_(std::move(records)),
      own_octants_(octants.of_rank(ranks.rank())) {
    std::vector<std::vector<Record>> to(static_cast<std::size_t>(ranks_.size()));
    for (const Record& r : records_) {
        to[static_cast<std::size_t>(octants_.owner_of(r.position))].push_back(r);
    }
    records_ = std::vector<Record>();
    records_ = exchange(to);
    to.clear();
    sources_in_.assign(octants_.tree().leaves(), {});
    for (std::uint32_t k = 0; k < records_.size(); ++k) {
        sources_in_[octants_.tree().find(records_[k].position)].all.push_back(k);
    }
    if (counts_ != Counts::everywhere) find_filled_parts();
    if (!has_tensors_) {
        find_bounds();
        return;
    }
    find_needs();
    kept_ = tensors_->kept();
}

void SharedSources::find_needs() {
    if (!has_tensors_ || tensors_) return;
    std::vector<std::vector<Box>> boxes;
    boxes.reserve(own_octants_.size());
    for (const LeafIndex octant : own_octants_) {
        boxes.push_back(test_boxes(octants_.places()[octant]));
    }
    tensors_ = std::make_unique<TensorNeeds>(ranks_, octants_, space_, steepest_, records_, boxes);
}

std::vector<Record> SharedSources::exchange(const std::vector<std::vector<Record>>& to) const {
    if (has_tensors_) return ranks_.exchange(to).values;
    std::vector<std::vector<LengthRecord>> lengths;
    lengths.reserve(to.size());
    for (const auto& records : to) lengths.emplace_back(records.begin(), records.end());
    const auto received = ranks_.exchange(lengths).values;
    return {received.begin(), received.end()};
}

// Finds the own sources that are not dominated, and lengths that the field does not exceed in
// boxes which make up the octants.
void SharedSources::find_bounds() {
    std::optional<IsotropicCones> own_cones;
    ranks_.together([&] {
        own_cones.emplace(columns_of(sources_of(records_)), ratio_, cap_);
        for (const std::uint32_t k : own_cones->kept()) {
            sources_in_[octants_.tree().find(records_[k].position)].kept.push_back(k);
        }
        kept_ = own_cones->kept().size();
    });
    const auto known = bounds_of_octants();
    tests_.clear();
    first_test_.assign(1, 0);
    for (const LeafPlace& place : octants_.places()) {
        for (const Box& box : test_boxes(place)) tests_.push_back({box, known[place.leaf]});
        first_test_.push_back(tests_.size());
    }
    std::vector<double> most(tests_.size());
    IsotropicCones::Hint hint = 0;
    for (std::size_t i = 0; i < tests_.size(); ++i) {
        most[i] = tests_[i].most;
        const auto k = own_cones->source_below(tests_[i].box.centre(), most[i], hint);
        if (k) most[i] = std::min(most[i], bound_of(records_[*k]).most_in(tests_[i].box));
    }
    ranks_.reduce(most, MPI_MIN);
    for (std::size_t i = 0; i < tests_.size(); ++i) tests_[i].most = most[i];
}

SharedSources::Bound SharedSources::bound_of(const Record& r) const {
    return {r.position, r.metric.xx, slope_of(r, ratio_)};
}

// In each octant, from one source of each.
std::vector<double> SharedSources::bounds_of_octants() {
    std::vector<Bound> of_octants;
    for (const LeafIndex leaf : own_octants_) {
        Bound least;
        double least_most = std::numeric_limits<double>::infinity();
        for (const std::uint32_t k : sources_in_[leaf].kept) {
            const Bound bound = bound_of(records_[k]);
            if (const double most = bound.most_in(octants_.box(leaf)); most < least_most) {
                least_most = most;
                least = bound;
            }
        }
        of_octants.push_back(least);
    }
    const std::vector<Bound> bounds = ranks_.gather(of_octants).values;
    std::vector<double> most;
    for (const LeafIndex leaf : own_octants_) {
        most.push_back(cap_);
        for (const Bound& b : bounds) {
            most.back() = std::min(most.back(), b.most_in(octants_.box(leaf)));
        }
    }
    const std::vector<double> all = ranks_.gather(most).values;
    std::vector<double> by_octant(octants_.tree().leaves());
    for (std::size_t i = 0; i < all.size(); ++i) by_octant[octants_.order()[i]] = all[i];
    return by_octant;
}

void SharedSources::find_filled_parts() {
    std::vector<std::bitset<Octants::most_parts>> own;
    for (const LeafIndex octant : own_octants_) {
        const std::vector<Box> parts = octants_.parts_of(octants_.places()[octant]);
        auto& filled = own.emplace_back();
        for (const std::uint32_t k : sources_in_[octant].all) {
            // On a plane it is in the part below, which comes first.
            const auto part = std::ranges::find_if(
                parts, [&](const Box& box) { return box.contains(records_[k].position); });
            filled.set(static_cast<std::size_t>(part - parts.begin()));
        }
    }
    const auto all = ranks_.gather(own).values;
    filled_.resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) filled_[octants_.order()[i]] = all[i];
}

// The smaller the boxes, the fewer sources seem to matter in them. Where an octant is cut for
// sources alone, parts without any are leaves, of which the centre or the corners alone take the
// field, or in leaves that were not cut.
std::vector<Box> SharedSources::test_boxes(const LeafPlace& octant) const {
    std::vector<Box> parts = octants_.parts_of(octant);
    if (counts_ == Counts::everywhere) return parts;
    std::vector<Point> places;
    const auto add_leaf = [&](const Box& leaf) {
        if (counts_ == Counts::at_centres) places.push_back(leaf.centre());
        for (int c = 0; counts_ == Counts::at_corners && c < 8; ++c) {
            places.push_back(corner(leaf, c));
        }
    };
    std::vector<Box> boxes;
    const auto& filled = filled_[octant.leaf];
    add_leaf(octant.box);
    const auto siblings = static_cast<std::size_t>(
        OctreeNode::even_subdivision(octants_.tree().domain(), octant.level + 1, parts[0])
            .children());
    for (std::size_t first = 0; filled.any() && first < parts.size(); first += siblings) {
        const std::size_t end = first + siblings;
        add_leaf({parts[first].low, parts[end - 1].high});
        bool is_filled = false;
        for (std::size_t k = first; k < end; ++k) is_filled = is_filled || filled[k];
        for (std::size_t k = first; is_filled && k < end; ++k) {
            if (filled[k]) {
                boxes.push_back(parts[k]);
            } else {
                add_leaf(parts[k]);
            }
        }
    }
    std::ranges::sort(places, precedes);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    for (const Point& x : places) boxes.push_back({x, x});
    return boxes;
}

/// By own source: whether it matters in any of some octants.
std::vector<std::uint8_t> SharedSources::matter_in(std::span<const LeafIndex> octants) const {
    if (has_tensors_) return tensors_->matter_in(octants);
    constexpr double safely = 1 + 1e-9;
    std::vector<std::uint8_t> matter(records_.size(), 0);
    std::vector<const Test*> near;
    for (const LeafIndex leaf : own_octants_) {
        const OwnSources& of = sources_in_[leaf];
        if (of.all.empty()) continue;
        near.clear();
        for (const LeafIndex other : octants) {
            for (const Test& test : tests_of(other)) {
                const double distance = distance_between(octants_.box(leaf), test.box);
                const double least =
                    octants_.least_length(leaf) + octants_.least_slope(leaf) * distance;
                if (least <= safely * test.most) near.push_back(&test);
            }
        }
        for (const std::uint32_t k : of.kept) {
            const Record& r = records_[k];
            const auto matters = [&](const Test* test) {
                const Vector away = nearest_in(test->box, r.position) - r.position;
                return r.metric.xx + slope_of(r, ratio_) * away.norm() <= safely * test->most;
            };
            matter[k] = std::ranges::any_of(near, matters) ? 1 : 0;
        }
    }
    return matter;
}

std::span<const SharedSources::Test> SharedSources::tests_of(LeafIndex octant) const {
    const std::size_t first = first_test_[octant];
    return std::span(tests_).subspan(first, first_test_[octant + std::size_t{1}] - first);
}

std::vector<PointSource> SharedSources::near(const std::vector<std::vector<LeafIndex>>& wanted,
                                             const std::vector<std::vector<LeafIndex>>& whole,
                                             std::uint64_t& received) {
    find_needs();
    std::vector<std::vector<Record>> to(wanted.size());
    for (std::size_t r = 0; r < wanted.size(); ++r) {
        // In octants that are wanted whole there is nothing to be found out.
        std::vector<std::uint8_t> is_whole(octants_.tree().leaves(), 0);
        for (const LeafIndex octant : whole[r]) is_whole[octant] = 1;
        const auto has_more = [&](LeafIndex octant) {
            return is_whole[octant] == 0 && !sources_in_[octant].all.empty();
        };
        std::vector<std::uint8_t> matter(records_.size(), 0);
        if (std::ranges::any_of(own_octants_, has_more)) matter = matter_in(wanted[r]);
        for (const LeafIndex octant : own_octants_) {
            for (const std::uint32_t k : sources_in_[octant].all) {
                if (is_whole[octant] != 0 || matter[k] != 0) to[r].push_back(records_[k]);
            }
        }
    }
    tensors_.reset();  // as much memory as the sources: found again for the next exchange
    const std::size_t from_self = to[static_cast<std::size_t>(ranks_.rank())].size();
    std::vector<Record> records = exchange(to);
    to.clear();
    received = records.size() - from_self;
    std::vector<PointSource> sources;
    ranks_.together([&] {
        std::ranges::sort(records, {}, &Record::index);
        sources = sources_of(records);
    });
    return sources;
}

}  // namespace controlspace

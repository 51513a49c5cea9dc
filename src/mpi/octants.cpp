// SPDX-License-Identifier: Apache-2.0
// The cutting and sharing out of octants.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/octants.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/insertion.h"
#include "trees/insertion/source_cuts.h"

namespace controlspace {

class Octants::Cutting {
public:
    Cutting(Octants& octants, Ranks& ranks, const DistributedOptions& options,
            std::span<const Record> records, const IsotropicCones* cones, double steepest)
        : octants_(octants),
          ranks_(ranks),
          options_(options),
          records_(records),
          cones_(cones),
          steepest_(steepest) {
        lengths_.reserve(records.size());
        for (const Record& r : records) {
            lengths_.push_back(is_isotropic(r.metric) ? r.metric.xx
                                                      : eigen_frame(r.metric).lengths[0]);
        }
    }

    // Cuts octants with many sources, as long as they are cut for certain.
    void run() {
        const std::uint64_t wanted =
            options_.octants_per_rank * static_cast<std::uint64_t>(ranks_.size());
        const int coarsest = (static_cast<int>(std::bit_width(wanted)) - 1) / 3;
        const std::uint64_t all = ranks_.reduced(std::uint64_t{records_.size()}, MPI_SUM);
        const SourceCuts<OctreeNode> cuts(options_.space);
        std::vector<LeafIndex> leaf_of(records_.size(), 0);
        octants_.places_ = {octants_.tree_.locate(options_.space.domain.centre())};
        while (true) {
            octants_.summary_ = summarize(leaf_of, cuts);
            const std::size_t before = octants_.tree_.leaves();
            std::vector<std::size_t> large;
            for (std::size_t i = 0; i < before; ++i) {
                const bool may_cut = octants_.places_[i].level < cuts.max_depth() &&
                                     cut_of(octants_.places_[i]).is_proper();
                // Few sources in a large octant would need many that are far away.
                const bool is_large =
                    octants_.places_[i].level < coarsest && octants_.summary_.count[i] > 0;
                if (may_cut && (is_large || octants_.summary_.count[i] > all / wanted)) {
                    large.push_back(i);
                }
            }
            const std::vector<int> cut_large = are_cut(large);
            std::vector<char> is_cut(before, 0);
            for (std::size_t k = 0; k < large.size(); ++k) {
                if (cut_large[k] == 0) continue;
                is_cut[large[k]] = 1;
                const LeafPlace parent = octants_.places_[large[k]];
                const Subdivision cut = cut_of(parent);
                octants_.tree_.split(parent, cut);
                octants_.places_.resize(octants_.tree_.leaves());
                for (int c = 0; c < cut.children(); ++c) {
                    const LeafPlace place =
                        octants_.tree_.locate_from(parent, cut.child(c).centre());
                    octants_.places_[place.leaf] = place;
                }
            }
            if (octants_.tree_.leaves() == before) break;
            for (std::size_t k = 0; k < records_.size(); ++k) {
                LeafIndex& leaf = leaf_of[k];
                if (is_cut[leaf] != 0) leaf = octants_.tree_.find(records_[k].position);
            }
        }
    }

    void share() {
        std::vector<std::uint64_t> weights(octants_.tree_.leaves());
        for (std::size_t i = 0; i < weights.size(); ++i) {
            // Leaves: of a surface as many as have room, but a few for each source at most.
            const auto count = static_cast<double>(octants_.summary_.count[i]);
            const double across = octants_.places_[i].box.edges().maxCoeff() * count /
                                  (options_.space.l_min * octants_.summary_.sum_of_lengths[i]);
            const double leaves = count > 0 ? std::min(across * across, 8 * count) : 0;
            weights[i] = 1 + static_cast<std::uint64_t>(count + leaves);
        }
        octants_.shared_ = share_out(ranks_.comm(), octants_.tree_, weights);
    }

private:
    Subdivision cut_of(const LeafPlace& place) const {
        return OctreeNode::even_subdivision(octants_.tree_.domain(), place.level, place.box);
    }

    Summary summarize(std::span<const LeafIndex> leaf_of, const SourceCuts<OctreeNode>& cuts) {
        Summary s(octants_.tree_.leaves());
        const Metric largest = largest_metric(options_.space);
        for (std::size_t k = 0; k < records_.size(); ++k) {
            const Record& r = records_[k];
            const LeafIndex leaf = leaf_of[k];
            ++s.count[leaf];
            s.sum_of_lengths[leaf] += lengths_[k];
            s.least_length[leaf] = std::min(s.least_length[leaf], lengths_[k]);
            s.least_slope[leaf] = std::min(s.least_slope[leaf], slope_of(r, options_.space.ratio));
            if (options_.target || r.index >= s.opener[leaf] / 2) continue;
            if (!calls_for_change(r.metric, largest, options_.space.tolerance)) continue;
            s.opener[leaf] =
                2 * r.index + (cuts.is_too_long(r.metric, octants_.places_[leaf].box) ? 0 : 1);
        }
        ranks_.reduce(s.count, MPI_SUM);
        ranks_.reduce(s.sum_of_lengths, MPI_SUM);  // rounding may depend on ranks_; answers do not
        ranks_.reduce(s.least_length, MPI_MIN);
        ranks_.reduce(s.least_slope, MPI_MIN);
        ranks_.reduce(s.opener, MPI_MIN);
        return s;
    }

    // Whether each of some octants is cut.
    std::vector<int> are_cut(std::span<const std::size_t> octants) {
        std::vector<int> cut(octants.size());
        if (!options_.target) {
            std::ranges::transform(octants, cut.begin(), [&](std::size_t i) {
                return octants_.summary_.opener[i] % 2 == 0;
            });
            return cut;
        }
        if (cones_ == nullptr) {
            std::ranges::transform(octants, cut.begin(), [&](std::size_t i) {
                return octants_.places_[i].box.edges().maxCoeff() >
                       octants_.summary_.least_length[i];
            });
            return cut;
        }
        const bool is_constant = options_.structure != "K_oV";
        const std::size_t numbers = is_constant ? 2 : grid * grid * grid;
        std::vector<double> of_field;
        of_field.reserve(numbers * octants.size());
        IsotropicCones::Hint hint = 0;
        for (const std::size_t i : octants) {
            if (is_constant) {
                const auto [least, most] = cones_->range_in(octants_.places_[i].box, hint);
                of_field.insert(of_field.end(), {least, most});
                continue;
            }
            for (int k = 0; k < grid * grid * grid; ++k) {
                of_field.push_back(
                    cones_->smallest_length(grid_place(octants_.places_[i].box, k), hint));
            }
        }
        ranks_.reduce(of_field, MPI_MIN);
        for (std::size_t i = 0; i < octants.size(); ++i) {
            const auto field = std::span(of_field).subspan(numbers * i, numbers);
            const double middle =
                is_constant ? std::sqrt(field[0] * field[1]) : trilinear(field, 13);
            if (is_negligible(octants_.places_[octants[i]].box, middle)) continue;
            for (std::size_t k = 0; k < numbers; ++k) {
                const double tree_length =
                    is_constant ? middle : trilinear(field, static_cast<int>(k));
                cut[i] |= departs(tree_length, field[k]) ? 1 : 0;
            }
        }
        return cut;
    }
    // Corners, the middles of edges and faces, and the centre of a box: number 13.
    static constexpr int grid = 3;
    static Point grid_place(const Box& box, int k) {
        const std::array steps{k % grid, k / grid % grid, k / (grid * grid)};
        Point x = box.centre();
        for (Axis a = 0; a < 3; ++a) {
            const int step = steps[static_cast<std::size_t>(a)];
            if (step != 1) x[a] = step == 0 ? box.low[a] : box.high[a];
        }
        return x;
    }
    // Of the lengths at the corners.
    static double trilinear(std::span<const double> at_grid, int k) {
        double sum = 0;
        for (int c = 0; c < 8; ++c) {
            double weight = 1;
            for (int step = k, bit = 0; bit < 3; ++bit, step /= grid) {
                const double t = 0.5 * (step % grid);
                weight *= (c >> bit & 1) != 0 ? t : 1 - t;
            }
            const int corner = 2 * (c & 1) + 2 * grid * (c >> 1 & 1) + 2 * grid * grid * (c >> 2);
            sum += weight * at_grid[static_cast<std::size_t>(corner)];
        }
        return sum;
    }
    bool departs(double length, double field) const {
        constexpr double safely = 1 + 1e-6;
        return nonconformity(Metric::isotropic(length), Metric::isotropic(field)) >
               safely * *options_.target;
    }
    // Boxes far shorter than an element are not cut (GrowingTree): some that are longer neither.
    bool is_negligible(const Box& box, double length) const {
        return box.edges().maxCoeff() < length / 8 * std::min(1.0, 0.25 / (steepest_ - 1));
    }

    Octants& octants_;
    Ranks& ranks_;
    const DistributedOptions& options_;
    std::span<const Record> records_;
    const IsotropicCones* cones_;
    double steepest_;
    std::vector<double> lengths_;  // the smallest of each source
};

Octants::Octants(Ranks& ranks, const DistributedOptions& options, std::span<const Record> records,
                 const IsotropicCones* cones, double steepest)
    : tree_(options.space.domain) {
    Cutting cutting(*this, ranks, options, records, cones, steepest);
    cutting.run();
    cutting.share();
}

std::vector<LeafIndex> Octants::of_rank(int rank) const {
    std::vector<LeafIndex> octants;
    std::ranges::copy_if(order(), std::back_inserter(octants),
                         [&](LeafIndex octant) { return owner(octant) == rank; });
    return octants;
}

std::vector<Box> Octants::boxes_of_rank(int rank) const {
    const std::vector<LeafIndex> octants = of_rank(rank);
    std::vector<Box> boxes(octants.size());
    std::ranges::transform(octants, boxes.begin(), [&](LeafIndex octant) { return box(octant); });
    return boxes;
}

std::vector<Box> Octants::parts_of(const LeafPlace& octant) const {
    constexpr int levels = 2;
    std::vector<Box> boxes{octant.box};
    for (int k = 0; k < levels; ++k) {
        std::vector<Box> parts;
        for (const Box& box : boxes) {
            const Subdivision cut =
                OctreeNode::even_subdivision(tree_.domain(), octant.level + k, box);
            for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
        }
        boxes = std::move(parts);
    }
    return boxes;
}

}  // namespace controlspace

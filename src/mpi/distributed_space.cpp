#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/distributed_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "cones/isotropic_cones.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"
#include "controlspace/space/insertion.h"
#include "controlspace/trees/leaf_metrics.h"
#include "mpi/exchange.h"
#include "mpi/rank_tree.h"
#include "mpi/shared_octants.h"
#include "trees/values/vertex_values.h"

// Why the answers do not depend on the ranks
// ------------------------------------------
// Octants are boxes of the serial octree that are cut there for certain, before anything else could
// have changed them: inserted into, a box that holds M_max is cut by the first source in it that
// calls for a change, provided that the box is too long for this source, and its parts hold M_max
// again. (If that source is content with the box, it stays one octant.) Adapted to a field, a box
// is cut where the bounds of the field in it, or lengths at some places, depart from what it would
// hold by more than the target, which the ranks find together. Below, an octant's part of the tree
// depends on its own sources, in their order, and on the field in it.
//
// The field is the minimum of cones, to the bit, whatever other cones are searched. Some cone stays
// below U everywhere in an octant B: what is above U everywhere in B is nowhere the smallest in it,
// nor is it in bounds of any box inside of B. All others go to the owner of B, up to rounding.

namespace controlspace {
namespace {

/// A source on its way.
struct Record {
    Point position;
    double length, growth;
    std::uint64_t index;  ///< among those of all ranks

    PointSource source() const { return {position, Metric::isotropic(length), growth}; }
};

/// A cone that bounds the field.
struct Bound {
    Point position = Point::Zero();
    double length = std::numeric_limits<double>::infinity(), slope = 0;

    double most_in(const Box& box) const {
        const Vector away = (box.centre() - position).cwiseAbs() + 0.5 * box.edges();
        return length + slope * away.norm();
    }
};

/// A box in which the field is nowhere longer than `most`.
struct Test {
    Box box;
    double most;
};

double process_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double distance_between(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).norm();
}

/// What is known of the sources in each leaf of the octree.
struct Summary {
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    static constexpr std::uint64_t nothing = ~std::uint64_t{0};

    explicit Summary(std::size_t leaves)
        : count(leaves, 0),
          sum_of_lengths(leaves, 0),
          least_length(leaves, infinity),
          least_slope(leaves, infinity),
          opener(leaves, nothing) {}
    std::vector<std::uint64_t> count;
    std::vector<double> sum_of_lengths, least_length, least_slope;
    /// Of the first source that calls for a change: twice its index, and 1 if the leaf is short
    /// enough for it.
    std::vector<std::uint64_t> opener;
};

}  // namespace

struct DistributedSpace::Impl {
    Impl(MPI_Comm comm, std::span<const PointSource> sources, const DistributedOptions& wanted)
        : ranks(comm), options(wanted), tree(wanted.space.domain) {
        const double start = process_seconds();
        report.given = sources.size();
        const std::uint64_t first = ranks.sum_before(sources.size());
        ranks.together([&] { read(sources, first); });
        all_sources = ranks.reduced(report.given, MPI_SUM);
        find_steepest();
        drop_dominated();
        cut_octants();
        cones.reset();
        send_to_owners();
        find_bounds();
        std::vector<std::vector<LeafIndex>> of_ranks(static_cast<std::size_t>(ranks.size()));
        for (const LeafIndex leaf : shared.order) {
            of_ranks[static_cast<std::size_t>(shared.owner[leaf])].push_back(leaf);
        }
        report.octants = of_ranks[static_cast<std::size_t>(ranks.rank())].size();
        report.octants_of_all = tree.leaves();
        own = build(of_ranks, report);
        const int first_short = ranks.least(report.met ? ranks.size() : ranks.rank());
        report.met = first_short == ranks.size();
        if (!report.met) {
            const std::string& text = report.remark;
            const auto remark =
                ranks.broadcast(std::vector<char>(text.begin(), text.end()), first_short);
            report.remark.assign(remark.begin(), remark.end());
        }
        report.cpu_s = process_seconds() - start;
    }

    double cap() const { return largest_metric(options.space).xx; }
    double slope_of(const Record& r) const { return cone_growth(r.growth, ratio()) - 1; }
    double ratio() const { return options.space.ratio; }
    std::vector<LeafIndex> own_octants() const {
        std::vector<LeafIndex> leaves;
        for (const LeafIndex leaf : shared.order) {
            if (shared.owner[leaf] == ranks.rank()) leaves.push_back(leaf);
        }
        return leaves;
    }

    void read(std::span<const PointSource> sources, std::uint64_t first) {
        require_valid(options.space);
        if (options.structure != "K_oL" && !(options.structure == "K_oV" && options.target)) {
            throw InputError(fmt::format(
                "{}{} depends on the order in which the whole tree is made, and is not built by "
                "ranks: give K_oL, or K_oV with target_delta",
                options.structure, options.target ? "" : ", inserted and graded,"));
        }
        if (options.octants_per_rank == 0) throw InputError("octants per rank: give at least 1");
        records.reserve(sources.size());
        for (std::size_t i = 0; i < sources.size(); ++i) {
            const PointSource& s = sources[i];
            require_valid(s, first + i, options.space.domain);
            if (!is_isotropic(s.metric)) {
                throw InputError(
                    fmt::format("source {} is a tensor: ranks build fields of lengths alone; give "
                                "--isotropic, or build it without MPI",
                                first + i));
            }
            records.push_back({s.position, s.metric.xx, s.growth, first + i});
        }
    }

    // How steep the field may be counts in adaptation.
    void find_steepest() {
        const auto growth = [&](const Record& r) { return cone_growth(r.growth, ratio()); };
        double own_most = 0;
        for (const Record& r : records) own_most = std::max(own_most, growth(r));
        const double most = ranks.reduced(own_most, MPI_MAX);
        if (!(most > ratio())) return;
        const int rank = ranks.least(own_most == most ? ranks.rank() : ranks.size());
        std::vector<Record> one;
        if (rank == ranks.rank()) one.push_back(*std::ranges::find(records, most, growth));
        steepest = ranks.broadcast(one, rank);
    }

    // Where leaves are not cut for sources, those that others dominate count for nothing.
    void drop_dominated() {
        if (!options.target) return;
        ranks.together([&] {
            cones.emplace(sources_of(records), ratio(), cap());
            std::vector<std::uint32_t> kept(cones->kept().begin(), cones->kept().end());
            std::ranges::sort(kept);
            for (std::size_t k = 0; k < kept.size(); ++k) records[k] = records[kept[k]];
            records.resize(kept.size());
            records.shrink_to_fit();
        });
        all_sources = ranks.reduced(std::uint64_t{records.size()}, MPI_SUM);
    }
    static std::vector<PointSource> sources_of(std::span<const Record> records) {
        std::vector<PointSource> sources;
        sources.reserve(records.size() + 1);
        for (const Record& r : records) sources.push_back(r.source());
        return sources;
    }

    // Cuts octants with many sources, as long as they are cut for certain.
    void cut_octants() {
        const std::uint64_t wanted =
            options.octants_per_rank * static_cast<std::uint64_t>(ranks.size());
        const int coarsest = (static_cast<int>(std::bit_width(wanted)) - 1) / 3;
        const SourceCuts<OctreeNode> cuts(options.space);
        std::vector<LeafIndex> leaf_of(records.size(), 0);
        places = {tree.locate(options.space.domain.centre())};
        while (true) {
            summary = summarize(leaf_of, cuts);
            const std::size_t before = tree.leaves();
            std::vector<std::size_t> large;
            for (std::size_t i = 0; i < before; ++i) {
                const bool may_cut =
                    places[i].level < cuts.max_depth() && cut_of(places[i]).is_proper();
                // Few sources in a large octant would need many that are far away.
                const bool is_large = places[i].level < coarsest && summary.count[i] > 0;
                if (may_cut && (is_large || summary.count[i] > all_sources / wanted)) {
                    large.push_back(i);
                }
            }
            const std::vector<int> cut_large = are_cut(large);
            std::vector<char> is_cut(before, 0);
            for (std::size_t k = 0; k < large.size(); ++k) {
                if (cut_large[k] == 0) continue;
                is_cut[large[k]] = 1;
                const LeafPlace parent = places[large[k]];
                const Subdivision cut = cut_of(parent);
                tree.split(parent, cut);
                places.resize(tree.leaves());
                for (int c = 0; c < cut.children(); ++c) {
                    const LeafPlace place = tree.locate_from(parent, cut.child(c).centre());
                    places[place.leaf] = place;
                }
            }
            if (tree.leaves() == before) break;
            for (std::size_t k = 0; k < records.size(); ++k) {
                LeafIndex& leaf = leaf_of[k];
                if (is_cut[leaf] != 0) leaf = tree.find(records[k].position);
            }
        }
    }
    Subdivision cut_of(const LeafPlace& place) const {
        return OctreeNode::even_subdivision(tree.domain(), place.level, place.box);
    }

    Summary summarize(std::span<const LeafIndex> leaf_of, const SourceCuts<OctreeNode>& cuts) {
        Summary s(tree.leaves());
        const Metric largest = largest_metric(options.space);
        for (std::size_t k = 0; k < records.size(); ++k) {
            const Record& r = records[k];
            const LeafIndex leaf = leaf_of[k];
            ++s.count[leaf];
            s.sum_of_lengths[leaf] += r.length;
            s.least_length[leaf] = std::min(s.least_length[leaf], r.length);
            s.least_slope[leaf] = std::min(s.least_slope[leaf], slope_of(r));
            if (options.target || r.index >= s.opener[leaf] / 2) continue;
            const Metric m = Metric::isotropic(r.length);
            if (!calls_for_change(m, largest, options.space.tolerance)) continue;
            s.opener[leaf] = 2 * r.index + (cuts.is_too_long(m, places[leaf].box) ? 0 : 1);
        }
        ranks.reduce(s.count, MPI_SUM);
        ranks.reduce(s.sum_of_lengths, MPI_SUM);  // rounding may depend on ranks; answers do not
        ranks.reduce(s.least_length, MPI_MIN);
        ranks.reduce(s.least_slope, MPI_MIN);
        ranks.reduce(s.opener, MPI_MIN);
        return s;
    }

    // Whether each of some octants is cut.
    std::vector<int> are_cut(std::span<const std::size_t> octants) {
        std::vector<int> cut(octants.size());
        if (!options.target) {
            std::ranges::transform(octants, cut.begin(),
                                   [&](std::size_t i) { return summary.opener[i] % 2 == 0; });
            return cut;
        }
        const bool is_constant = options.structure == "K_oL";
        const std::size_t numbers = is_constant ? 2 : grid * grid * grid;
        std::vector<double> of_field;
        of_field.reserve(numbers * octants.size());
        IsotropicCones::Hint hint = 0;
        for (const std::size_t i : octants) {
            if (is_constant) {
                const auto [least, most] = cones->range_in(places[i].box, hint);
                of_field.insert(of_field.end(), {least, most});
                continue;
            }
            for (int k = 0; k < grid * grid * grid; ++k) {
                of_field.push_back(cones->smallest_length(grid_place(places[i].box, k), hint));
            }
        }
        ranks.reduce(of_field, MPI_MIN);
        for (std::size_t i = 0; i < octants.size(); ++i) {
            const auto field = std::span(of_field).subspan(numbers * i, numbers);
            const double middle =
                is_constant ? std::sqrt(field[0] * field[1]) : trilinear(field, 13);
            if (is_negligible(places[octants[i]].box, middle)) continue;
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
               safely * *options.target;
    }
    // Boxes far shorter than an element are not cut (GrowingTree): some that are longer neither.
    bool is_negligible(const Box& box, double length) const {
        const double growth = steepest.empty() ? ratio() : steepest.front().growth;
        return box.edges().maxCoeff() < length / 8 * std::min(1.0, 0.25 / (growth - 1));
    }

    void send_to_owners() {
        std::vector<std::uint64_t> weights(tree.leaves());
        for (std::size_t i = 0; i < weights.size(); ++i) {
            // Leaves: of a surface as many as have room, but a few for each source at most.
            const auto count = static_cast<double>(summary.count[i]);
            const double across = places[i].box.edges().maxCoeff() * count /
                                  (options.space.l_min * summary.sum_of_lengths[i]);
            const double leaves = count > 0 ? std::min(across * across, 8 * count) : 0;
            weights[i] = 1 + static_cast<std::uint64_t>(count + leaves);
        }
        shared = share_out(ranks.comm(), tree, weights);
        std::vector<std::vector<Record>> to(static_cast<std::size_t>(ranks.size()));
        for (const Record& r : records) {
            to[static_cast<std::size_t>(shared.owner[tree.find(r.position)])].push_back(r);
        }
        records = std::vector<Record>();
        records = ranks.exchange(to).values;
        report.owned = records.size();
    }

    // Finds the own sources that are not dominated, and lengths that the field does not exceed in
    // boxes which make up the octants.
    void find_bounds() {
        sources_in.assign(tree.leaves(), {});
        std::optional<IsotropicCones> own_cones;
        ranks.together([&] {
            own_cones.emplace(sources_of(records), ratio(), cap());
            for (std::uint32_t k = 0; k < records.size(); ++k) {
                sources_in[tree.find(records[k].position)].all.push_back(k);
            }
            for (const std::uint32_t k : own_cones->kept()) {
                sources_in[tree.find(records[k].position)].kept.push_back(k);
            }
            report.kept = own_cones->kept().size();
        });
        const auto known = bounds_of_octants();
        tests.clear();
        first_test.assign(1, 0);
        for (const LeafPlace& place : places) {
            add_tests(place, known[place.leaf]);
            first_test.push_back(tests.size());
        }
        std::vector<double> most(tests.size());
        IsotropicCones::Hint hint = 0;
        for (std::size_t i = 0; i < tests.size(); ++i) {
            most[i] = tests[i].most;
            const auto k = own_cones->source_below(tests[i].box.centre(), most[i], hint);
            if (k) most[i] = std::min(most[i], bound_of(records[*k]).most_in(tests[i].box));
        }
        ranks.reduce(most, MPI_MIN);
        for (std::size_t i = 0; i < tests.size(); ++i) tests[i].most = most[i];
    }
    Bound bound_of(const Record& r) const { return {r.position, r.length, slope_of(r)}; }

    // In each octant, from one source of each.
    std::vector<double> bounds_of_octants() {
        std::vector<Bound> of_octants;
        for (const LeafIndex leaf : own_octants()) {
            Bound least;
            double least_most = std::numeric_limits<double>::infinity();
            for (const std::uint32_t k : sources_in[leaf].kept) {
                const Bound bound = bound_of(records[k]);
                if (const double most = bound.most_in(places[leaf].box); most < least_most) {
                    least_most = most;
                    least = bound;
                }
            }
            of_octants.push_back(least);
        }
        const std::vector<Bound> bounds = ranks.gather(of_octants).values;
        std::vector<double> most;
        for (const LeafIndex leaf : own_octants()) {
            most.push_back(cap());
            for (const Bound& b : bounds) {
                most.back() = std::min(most.back(), b.most_in(places[leaf].box));
            }
        }
        const std::vector<double> all = ranks.gather(most).values;
        std::vector<double> by_octant(tree.leaves());
        for (std::size_t i = 0; i < all.size(); ++i) by_octant[shared.order[i]] = all[i];
        return by_octant;
    }

    // The smaller the boxes, the fewer sources seem to matter in them. Inserted into, an octant
    // without sources is one leaf, of which the centre alone takes the field.
    void add_tests(const LeafPlace& octant, double most) {
        if (!options.target && summary.count[octant.leaf] == 0) {
            const Point centre = octant.box.centre();
            tests.push_back({{centre, centre}, most});
            return;
        }
        constexpr int levels = 2;
        std::vector<Box> boxes{octant.box};
        for (int k = 0; k < levels; ++k) {
            std::vector<Box> parts;
            for (const Box& box : boxes) {
                const Subdivision cut =
                    OctreeNode::even_subdivision(tree.domain(), octant.level + k, box);
                for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
            }
            boxes = std::move(parts);
        }
        for (const Box& box : boxes) tests.push_back({box, most});
    }

    /// Calls visit(number) for the own sources that matter in any of some octants, or lie there.
    template <class Visit>
    void for_each_that_matters(std::span<const LeafIndex> in, const Visit& visit) const {
        constexpr double safely = 1 + 1e-9;
        std::vector<char> is_in(tree.leaves(), 0);
        for (const LeafIndex leaf : in) is_in[leaf] = 1;
        std::vector<const Test*> near;
        for (const LeafIndex leaf : own_octants()) {
            const OwnSources& of = sources_in[leaf];
            if (is_in[leaf] != 0) {
                for (const std::uint32_t k : of.all) visit(k);
                continue;
            }
            if (of.all.empty()) continue;
            near.clear();
            for (const LeafIndex other : in) {
                for (const Test& test : tests_of(other)) {
                    const double distance = distance_between(places[leaf].box, test.box);
                    const double least =
                        summary.least_length[leaf] + summary.least_slope[leaf] * distance;
                    if (least <= safely * test.most) near.push_back(&test);
                }
            }
            for (const std::uint32_t k : of.kept) {
                const Record& r = records[k];
                const auto matters = [&](const Test* test) {
                    const Vector away = nearest_in(test->box, r.position) - r.position;
                    return r.length + slope_of(r) * away.norm() <= safely * test->most;
                };
                if (std::ranges::any_of(near, matters)) visit(k);
            }
        }
    }
    std::span<const Test> tests_of(LeafIndex octant) const {
        const std::size_t first = first_test[octant];
        return std::span(tests).subspan(first, first_test[octant + std::size_t{1}] - first);
    }

    /// The field in the octants that each rank wants, from the sources of all.
    std::unique_ptr<ControlSpace> build(const std::vector<std::vector<LeafIndex>>& wanted,
                                        RankReport& about) {
        std::vector<std::vector<Record>> to(wanted.size());
        for (std::size_t r = 0; r < wanted.size(); ++r) {
            for_each_that_matters(wanted[r], [&](std::uint32_t k) { to[r].push_back(records[k]); });
        }
        const std::size_t from_self = to[static_cast<std::size_t>(ranks.rank())].size();
        std::vector<Record> near = ranks.exchange(to).values;
        to.clear();
        about.received = near.size() - from_self;
        std::unique_ptr<ControlSpace> made;
        ranks.together([&] {
            std::vector<Box> octants;
            std::vector<char> is_wanted(tree.leaves(), 0);
            for (const LeafIndex leaf : wanted[static_cast<std::size_t>(ranks.rank())]) {
                octants.push_back(places[leaf].box);
                is_wanted[leaf] = 1;
            }
            // In the order that the sources have in all.
            std::ranges::sort(near, {}, &Record::index);
            std::vector<PointSource> sources = sources_of(near);
            near = std::vector<Record>();
            if (!options.target) {
                made = inserted(sources, is_wanted, octants, about);
            } else if (options.structure == "K_oL") {
                made = adapted<LeafMetrics>(sources, is_wanted, octants, about);
            } else {
                made = adapted<VertexValues>(sources, is_wanted, octants, about);
            }
        });
        return made;
    }

    template <class Storage>
    std::unique_ptr<ControlSpace> adapted(std::vector<PointSource>& sources,
                                          std::span<const char> is_wanted,
                                          std::span<const Box> octants, RankReport& about) const {
        const SpaceOptions& space = options.space;
        const auto made = std::make_shared<AdaptedPart<Storage>>(space, octants);
        for (const Record& r : steepest) sources.push_back(r.source());
        const AdaptationReport outcome =
            made->adapt({.sources = sources,
                         .continuous = nullptr,
                         .ratio = space.ratio,
                         .target = *options.target,
                         .intersection = space.intersection,
                         .h_max = space.h_max},
                        [&](const Point& x) { return is_wanted[tree.find(x)] != 0; });
        about.met = outcome.met;
        about.remark = outcome.shortfall;
        about.leaves = made->footprint().cells;
        return std::make_unique<SharedSpace<AdaptedPart<Storage>>>(made);
    }

    std::unique_ptr<ControlSpace> inserted(std::vector<PointSource>& sources,
                                           std::span<const char> is_wanted,
                                           std::span<const Box> octants, RankReport& about) const {
        const auto made = std::make_shared<InsertedPart<LeafMetrics>>(options.space, octants);
        GivenSources given;
        given.add(sources);
        std::erase_if(sources, [&](const PointSource& source) {
            return is_wanted[tree.find(source.position)] == 0;
        });
        made->insert(sources);
        sources = std::vector<PointSource>();
        made->grade(NodeGradation({.ratio = ratio()}, &given, options.space));
        made->finish();
        about.leaves = made->footprint().cells;
        using Tree = MetricTree<OctreeNode, LeafMetrics>;
        return std::make_unique<SharedSpace<Tree>>(made);
    }

    struct OwnSources {
        std::vector<std::uint32_t> all, kept;
    };

    mutable Ranks ranks;
    DistributedOptions options;
    Topology<OctreeNode> tree;      // its leaves are the octants, the same on all ranks
    std::vector<LeafPlace> places;  // of the octants
    Summary summary{0};
    SharedOctants shared;
    std::vector<Test> tests;              // of octants, one after the other
    std::vector<std::size_t> first_test;  // of each octant, and the end
    std::uint64_t all_sources = 0;
    std::vector<Record> steepest;         // one source, if any is steeper than the ratio
    std::optional<IsotropicCones> cones;  // of the sources given, until octants are cut
    std::vector<Record> records;          // sources: those given, then those owned
    std::vector<OwnSources> sources_in;   // of octants
    std::unique_ptr<ControlSpace> own;
    RankReport report;
};

DistributedSpace::DistributedSpace(MPI_Comm comm, std::span<const PointSource> sources,
                                   const DistributedOptions& options)
    : impl_(std::make_unique<Impl>(comm, sources, options)) {}
DistributedSpace::~DistributedSpace() = default;
DistributedSpace::DistributedSpace(DistributedSpace&&) noexcept = default;
DistributedSpace& DistributedSpace::operator=(DistributedSpace&&) noexcept = default;

const ControlSpace& DistributedSpace::own() const { return *impl_->own; }

std::vector<Box> DistributedSpace::octants() const {
    std::vector<Box> boxes;
    for (const LeafIndex leaf : impl_->own_octants()) boxes.push_back(impl_->places[leaf].box);
    return boxes;
}

int DistributedSpace::owner_of(const Point& x) const {
    return impl_->shared.owner[impl_->tree.find(nearest_in(impl_->tree.domain(), x))];
}

std::unique_ptr<ControlSpace> DistributedSpace::field_for(const Box& box) const {
    const auto boxes = impl_->ranks.gather(std::vector<Box>{box}).values;
    std::vector<std::vector<LeafIndex>> wanted(boxes.size());
    for (std::size_t r = 0; r < boxes.size(); ++r) {
        for (const LeafPlace& place : impl_->places) {
            if (distance_between(place.box, boxes[r]) == 0) wanted[r].push_back(place.leaf);
        }
    }
    RankReport about;
    return impl_->build(wanted, about);
}

void DistributedSpace::sample(std::span<const Point> x, std::span<Metric> out) const {
    Ranks& ranks = impl_->ranks;
    std::vector<std::vector<Point>> to(static_cast<std::size_t>(ranks.size()));
    std::vector<std::vector<std::size_t>> numbers(to.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto owner = static_cast<std::size_t>(owner_of(x[i]));
        to[owner].push_back(x[i]);
        numbers[owner].push_back(i);
    }
    const auto asked = ranks.exchange(to);
    std::vector<Metric> answers(asked.values.size());
    ranks.together([&] { own().sample(asked.values, answers); });
    std::vector<std::vector<Metric>> back(to.size());
    auto next = answers.begin();
    for (std::size_t r = 0; r < back.size(); ++r) {
        back[r].assign(next, next + asked.counts[r]);
        next += asked.counts[r];
    }
    const std::vector<Metric> found = ranks.exchange(back).values;
    std::size_t k = 0;
    for (const auto& of_rank : numbers) {
        for (const std::size_t i : of_rank) out[i] = found[k++];
    }
}

std::uint64_t DistributedSpace::checksum(std::size_t n, std::uint64_t seed) const {
    Ranks& ranks = impl_->ranks;
    const auto border = [&](int r) {
        return n * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks.size());
    };
    std::vector<Point> x;
    ranks.together([&] { x = random_points(impl_->tree.domain(), n, seed); });
    const std::size_t begin = border(ranks.rank());
    const std::vector<Point> part(
        x.begin() + static_cast<std::ptrdiff_t>(begin),
        x.begin() + static_cast<std::ptrdiff_t>(border(ranks.rank() + 1)));
    std::vector<Metric> answers(part.size());
    sample(part, answers);
    return controlspace::checksum(ranks.gather(answers).values);
}

RankReport DistributedSpace::report() const {
    RankReport report = impl_->report;
    report.bytes_sent = impl_->ranks.bytes();
    report.messages_sent = impl_->ranks.messages();
    return report;
}

}  // namespace controlspace

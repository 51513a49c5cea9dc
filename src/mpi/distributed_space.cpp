// SPDX-License-Identifier: Apache-2.0
// Control spaces that are built by many ranks, and their queries.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/distributed_space.h"

#include <algorithm>
#include <ctime>
#include <optional>
#include <ranges>
#include <utility>

#include "cones/isotropic_cones.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/order_free_intersection.h"
#include "controlspace/sources/cone.h"
#include "mpi/exchange.h"
#include "mpi/octants.h"
#include "mpi/pieces.h"
#include "mpi/rank_tree.h"
#include "mpi/record.h"
#include "mpi/shared_sources.h"
#include "refuse.h"
#include "space/saved.h"
#include "trees/topology/leaves_where.h"
#include "trees/values/constant_values.h"
#include "trees/values/vertex_values.h"

// Why the answers do not depend on the ranks: octants are cut as in the serial octree (octants.h),
// a rank has all sources that matter in its octants (shared_sources.h), and an octant's part of the
// tree depends on its own sources, in their order, and on the field in it.

namespace controlspace {
namespace {

double process_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

struct DistributedSpace::Impl {
    Impl(MPI_Comm comm, std::span<const PointSource> sources, const DistributedOptions& wanted)
        : ranks(comm), options(wanted), octants(wanted.space.domain) {
        const double start = process_seconds();
        report.given = sources.size();
        const std::uint64_t first = ranks.sum_before(sources.size());
        std::vector<Record> records;
        ranks.together([&] { records = read(sources, first); });
        const auto is_tensor = [](const Record& r) { return !is_isotropic(r.metric); };
        has_tensors = ranks.reduced(std::ranges::any_of(records, is_tensor) ? 1 : 0, MPI_MAX) != 0;
        ranks.together([&] { require_possible(); });
        find_steepest(records);
        const double largest_ratio = steepest ? steepest->growth : options.space.ratio;
        {
            const auto cones = drop_dominated(records);
            octants = Octants(ranks, options, records, cones ? &*cones : nullptr, largest_ratio);
        }
        report.has_tensors = has_tensors;
        near.emplace(ranks, octants, options, has_tensors, largest_ratio, std::move(records));
        report.owned = near->owned();
        report.kept = near->kept();
        std::vector<std::vector<LeafIndex>> of_ranks;
        of_ranks.reserve(static_cast<std::size_t>(ranks.size()));
        for (int r = 0; r < ranks.size(); ++r) of_ranks.push_back(octants.of_rank(r));
        report.octants = of_ranks[static_cast<std::size_t>(ranks.rank())].size();
        report.octants_of_all = octants.tree().leaves();
        own = build(of_ranks, report);
        dynamic_cast<Saved&>(*own).set_recipe(Recipe{options.structure, options.space});
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

    std::vector<Record> read(std::span<const PointSource> sources, std::uint64_t first) const {
        require_valid(options.space);
        if (options.octants_per_rank == 0) refuse("octants per rank: give at least 1");
        std::vector<Record> records;
        records.reserve(sources.size());
        for (std::size_t i = 0; i < sources.size(); ++i) {
            const PointSource& s = sources[i];
            require_valid(s, first + i, options.space.domain);
            if (!is_isotropic(s.metric)) require_order_free(s.metric, first + i);
            records.push_back({s.position, s.metric, s.growth, first + i});
        }
        return records;
    }

    static void require_order_free(const Metric& metric, std::uint64_t index) {
        try {
            order_free_intersection({&metric, 1});
        } catch (const InputError& error) {
            refuse("source {}: {}", index, error.what());
        }
    }

    void require_possible() const {
        const SpaceOptions& space = options.space;
        const std::string& name = options.structure;
        const bool has_order =
            (name == "K_oV" || name == "K_oLB") && !options.target && space.vertices_in_turn;
        if (has_order || (name != "K_oL" && name != "K_oV" && name != "K_oLB")) {
            refuse(
                "{} depends on the order in which the whole tree is made, and is not built by "
                "ranks: give K_oL, K_oV or K_oLB",
                name);
        }
        if (has_tensors && space.intersection == IntersectionRule::in_turn) {
            refuse("ranks intersect tensors without an order: leave out --intersection in-turn");
        }
    }

    // How steep the field may be counts in adaptation.
    void find_steepest(std::span<const Record> records) {
        const auto growth = [&](const Record& r) {
            return cone_growth(r.growth, options.space.ratio);
        };
        double own_most = 0;
        for (const Record& r : records) own_most = std::max(own_most, growth(r));
        const double most = ranks.reduced(own_most, MPI_MAX);
        if (!(most > options.space.ratio)) return;
        const int rank = ranks.least(own_most == most ? ranks.rank() : ranks.size());
        std::vector<Record> one;
        if (rank == ranks.rank()) one.push_back(*std::ranges::find(records, most, growth));
        steepest = ranks.broadcast(one, rank).front();
    }

    // Where leaves are not cut for sources, lengths that others dominate count for nothing.
    std::optional<IsotropicCones> drop_dominated(std::vector<Record>& records) {
        std::optional<IsotropicCones> cones;
        if (!options.target || has_tensors) return cones;
        ranks.together([&] {
            cones.emplace(columns_of(sources_of(records)), options.space.ratio,
                          largest_metric(options.space).xx);
            std::vector<std::uint32_t> kept(cones->kept().begin(), cones->kept().end());
            std::ranges::sort(kept);
            for (std::size_t k = 0; k < kept.size(); ++k) records[k] = records[kept[k]];
            records.resize(kept.size());
            records.shrink_to_fit();
        });
        return cones;
    }

    /// The field in the octants that each rank wants, from the sources of all.
    std::unique_ptr<ControlSpace> build(const std::vector<std::vector<LeafIndex>>& wanted,
                                        RankReport& about) {
        const auto whole = with_neighbours(wanted);
        // Where leaves follow the field, it must be exact around the octants too.
        std::vector<PointSource> sources =
            near->near(options.target ? whole : wanted, whole, about.received);
        std::unique_ptr<ControlSpace> made;
        ranks.together([&] {
            std::vector<Box> boxes;
            std::vector<char> is_wanted(octants.tree().leaves(), 0);
            for (const LeafIndex leaf : whole[static_cast<std::size_t>(ranks.rank())]) {
                boxes.push_back(octants.box(leaf));
                is_wanted[leaf] = 1;
            }
            made = options.target ? adapted(sources, is_wanted, boxes, about)
                                  : inserted(sources, is_wanted, boxes, about);
        });
        return made;
    }

    // With the octants whose leaves change something in these. A vertex of K_oV, inserted, takes
    // what the leaves around it request. In K_oLB a leaf is cut for another, which was cut for a
    // third and so on, each half as long as the one before: all of them are nearer than the first
    // is long. (Adapted to lengths, parts of a leaf within the target are within it too: a leaf
    // that is cut for another has no part that is cut for the field.)
    std::vector<std::vector<LeafIndex>> with_neighbours(
        const std::vector<std::vector<LeafIndex>>& some) const {
        const bool is_balanced = options.structure == "K_oLB";
        if (!is_balanced && (options.target || options.structure == "K_oL")) return some;
        const double reach = is_balanced ? 1 - 1e-6 : 0;
        std::vector<std::vector<LeafIndex>> all(some.size());
        for (std::size_t r = 0; r < some.size(); ++r) {
            std::vector<char> is_in(octants.tree().leaves(), 0);
            for (const LeafIndex octant : some[r]) {
                const Box& box = octants.box(octant);
                const Vector beyond = reach * box.edges();
                for_each_leaf_around(octants.tree(), {box.low - beyond, box.high + beyond},
                                     Neighbourhood::all, [&](LeafIndex leaf, const Box&) {
                                         if (std::exchange(is_in[leaf], 1) == 0) {
                                             all[r].push_back(leaf);
                                         }
                                     });
            }
        }
        return all;
    }

    MakeLeafModel<OctreeNode> model() const {
        return options.structure == "K_oV" ? new_model<VertexValues> : new_model<ConstantValues>;
    }
    template <template <class> class Model>
    static std::unique_ptr<LeafModel<OctreeNode>> new_model(const SpaceOptions& space) {
        return std::make_unique<Model<OctreeNode>>(space);
    }

    std::unique_ptr<ControlSpace> adapted(std::vector<PointSource>& sources,
                                          std::span<const char> is_wanted,
                                          std::span<const Box> boxes, RankReport& about) const {
        const SpaceOptions& space = options.space;
        const auto made =
            std::make_shared<AdaptedPart>(space, model(), options.structure == "K_oLB", boxes);
        if (steepest) sources.push_back(steepest->source());
        // A share for each rank would be too few where there are many.
        const std::size_t most_answers = ranks.size() == 1 ? GoalField::many_answers : 75'000;
        const AdaptationReport outcome = made->adapt(
            {.sources = sources,
             .continuous = nullptr,
             .ratio = space.ratio,
             .target = *options.target,
             .intersection = space.intersection,
             .h_max = space.h_max},
            most_answers, [&](const Point& x) { return is_wanted[octants.tree().find(x)] != 0; });
        about.met = outcome.met;
        about.remark = outcome.shortfall;
        about.leaves = made->footprint().cells;
        return std::make_unique<SharedSpace<AdaptedPart>>(made);
    }

    std::unique_ptr<ControlSpace> inserted(std::vector<PointSource>& sources,
                                           std::span<const char> is_wanted,
                                           std::span<const Box> boxes, RankReport& about) const {
        const auto made = std::make_shared<InsertedPart>(options.space, model(),
                                                         options.structure == "K_oLB", boxes);
        // Lengths as columns: 32 bytes in place of 80.
        SourceColumns lengths;
        if (!has_tensors) lengths = columns_of(std::exchange(sources, {}));
        made->insert(has_tensors ? where(sources, is_wanted) : where(lengths, is_wanted));
        const auto by_sources =
            has_tensors ? NodeGradation(options.space.ratio, sources, options.space)
                        : NodeGradation({.ratio = options.space.ratio}, &lengths, options.space);
        sources = std::vector<PointSource>();
        made->grade(by_sources);
        made->finish();
        about.leaves = made->footprint().cells;
        return std::make_unique<SharedSpace<MetricTree<OctreeNode>>>(made);
    }

    /// Those in octants that are wanted.
    std::vector<PointSource> where(const auto& sources, std::span<const char> is_wanted) const {
        const auto number = std::views::iota(std::size_t{0}, sources.size());
        const auto is_in = [&](std::size_t i) {
            return is_wanted[octants.tree().find(sources[i].position)] != 0;
        };
        std::vector<PointSource> found;
        found.reserve(static_cast<std::size_t>(std::ranges::count_if(number, is_in)));
        for (const std::size_t i : number | std::views::filter(is_in)) found.push_back(sources[i]);
        return found;
    }

    mutable Ranks ranks;
    DistributedOptions options;
    Octants octants;
    bool has_tensors = false;        // any rank
    std::optional<Record> steepest;  // of all sources, if steeper than the ratio
    std::optional<SharedSources> near;
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
    return impl_->octants.boxes_of_rank(impl_->ranks.rank());
}

int DistributedSpace::owner_of(const Point& x) const {
    return impl_->octants.owner_of(nearest_in(impl_->options.space.domain, x));
}

std::unique_ptr<ControlSpace> DistributedSpace::field_for(const Box& box) const {
    const auto boxes = impl_->ranks.gather(std::vector<Box>{box}).values;
    std::vector<std::vector<LeafIndex>> wanted(boxes.size());
    for (std::size_t r = 0; r < boxes.size(); ++r) {
        for (const LeafPlace& place : impl_->octants.places()) {
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

void DistributedSpace::save(const std::filesystem::path& index) const {
    save_pieces(impl_->ranks, impl_->octants, own(), index);
}

void DistributedSpace::write_leaves(const std::filesystem::path& index) const {
    write_pieces_of_leaves(impl_->ranks, impl_->octants, own(), index);
}

std::uint64_t DistributedSpace::checksum(std::size_t n, std::uint64_t seed) const {
    Ranks& ranks = impl_->ranks;
    const auto border = [&](int r) {
        return n * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks.size());
    };
    std::vector<Point> x;
    ranks.together([&] { x = random_points(impl_->options.space.domain, n, seed); });
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

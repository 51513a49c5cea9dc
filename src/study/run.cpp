// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <list>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "controlspace/space/control_space_file.h"
#include "controlspace/space/sample_parallel.h"
#include "measure/stopwatch.h"
#include "refuse.h"
#include "space/until_late.h"
#include "study/equal_setting.h"

namespace controlspace {
namespace {

template <class Callback, class... Arguments>
void notify(const std::function<Callback>& callback, Arguments&&... arguments) {
    if (callback) callback(arguments...);
}

/// Appends the times of a repeated creation.
void append(Creation& creation, const Creation& again) {
    creation.insert_s.push_back(again.insert_s.front());
    creation.gradation_s.push_back(again.gradation_s.front());
}

/// A case of a batch: its structure where it could be made, to be timed with the others.
struct Member {
    Row row;
    std::unique_ptr<ControlSpace> space;
    std::optional<Finished> finished;
};

/// Runs the cases of a study in batches.
class Runner {
public:
    Runner(const PreparedStudy& prepared, std::size_t finished_before,
           const StudyObserver& observer)
        : prepared_(prepared),
          study_(prepared.study()),
          rows_(prepared.rows()),
          finished_before_(finished_before),
          observer_(observer) {}

    /// `after(i)` is called when case i is done and its workload not needed for it any more.
    template <class After>
    void run(const After& after) {
        const auto cases = prepared_.cases();
        const double most_bytes = 0.5 * most_bytes_of_all();
        std::size_t first = 0;
        double bytes = 0;
        Stopwatch time;
        for (std::size_t i = 0; i < cases.size(); ++i) {
            make(i);
            const auto& finished = batch_.back().finished;
            if (finished) bytes += static_cast<double>(finished->footprint.bytes_total());
            const bool ends = i + 1 == cases.size() || !share_probes(cases[i], cases[i + 1]) ||
                              bytes > most_bytes || time.seconds() > longest_batch_s;
            if (!ends) continue;
            finish_batch();
            for (; first <= i; ++first) after(first);
            std::erase_if(probes_, [&](const auto& known) {
                return std::ranges::none_of(cases.subspan(i + 1), [&](const Case& c) {
                    return share_probes(c, cases[known.first]);
                });
            });
            bytes = 0;
            time = {};
        }
    }

private:
    /// Random, grid, near, single and walk; of lengths random and single of metrics, too.
    static constexpr double kinds_of_access = 7;
    /// An interrupted run loses no more.
    static constexpr double longest_batch_s = 600;

    /// Probes of case `i`, which earlier cases may have needed.
    const ReferenceProbes& probes_of(std::size_t i) {
        const Case& c = prepared_.cases()[i];
        for (const auto& [first, probes] : probes_) {
            if (share_probes(prepared_.cases()[first], c)) return *probes;
        }
        notify(observer_.phase_started, "reference field");
        return *probes_
                    .emplace_back(i, std::make_unique<ReferenceProbes>(
                                         make_reference_probes(study_, c, prepared_.workload(c))))
                    .second;
    }

    /// Adds a case to the batch.
    void make(std::size_t i) {
        const Case& c = prepared_.cases()[i];
        const Workload& workload = prepared_.workload(c);
        notify(observer_.case_started, c);
        const Stopwatch time;
        Member& member = batch_.emplace_back();
        member.row.setting = c;
        member.row.sources = workload.sources.size();
        RowLimits limits;
        try {
            const ReferenceProbes& probes = probes_of(i);
            limits = limits_of(i);
            const Chosen chosen = choose_voxels(member.row.setting, workload, probes, limits);
            make_and_check(member, i, workload, probes, limits);
            Creation& creation = member.finished->creation;
            if (!chosen.shortfall.empty()) creation.shortfall = chosen.shortfall;
            if (!chosen.stopped.empty()) creation.stopped = chosen.stopped;
            if (creation.stopped.empty()) {
                smallest_ = std::min(smallest_,
                                     static_cast<double>(member.finished->footprint.bytes_total()));
            }
        } catch (const GrowthStopped& stopped) {
            member.row.error = fmt::format("stopped {}, {} leaves", limits.place_of(stopped.stop()),
                                           stopped.leaves());
        } catch (const std::bad_alloc&) {
            member.row.error = "out of memory: lower max_memory, or raise tau";
        } catch (const std::exception& error) {
            member.row.error = error.what();
        }
        if (!member.row.error.empty()) {
            member.finished.reset();
            member.space.reset();
        } else if (observer_.case_checked) {
            observer_.case_checked(*member.finished, member.row);
        }
        member.row.seconds = time.seconds();
    }

    /// max_seconds from now.
    GrowthLimit limit_of_time(double least_s = 0) const {
        GrowthLimit limit;
        if (study_.max_seconds > 0) {
            const std::chrono::duration<double> most(std::clamp(study_.max_seconds, least_s, 1e9));
            limit.deadline = GrowthLimit::Clock::now() +
                             std::chrono::duration_cast<GrowthLimit::Clock::duration>(most);
        }
        return limit;
    }

    /// Of case `i`, whose time begins now.
    RowLimits limits_of(std::size_t i) {
        constexpr double least_bytes = 4.0 * 1024 * 1024;  // a grid of OpenVDB takes 1.8 MB
        if (i > 0 && !share_probes(prepared_.cases()[i - 1], prepared_.cases()[i])) {
            smallest_ = std::numeric_limits<double>::infinity();
        }
        RowLimits limits;
        limits.growth = limit_of_time();
        if (study_.max_seconds > 0) limits.time = fmt::format("{:.4g} s", study_.max_seconds);
        const double wanted_bytes = study_.max_memory_ratio * smallest_;
        const double bytes = std::max(wanted_bytes, least_bytes);
        if (study_.max_memory_ratio > 0 && bytes < most_bytes_of_all()) {
            limits.growth.bytes = static_cast<std::size_t>(bytes);
            limits.memory = wanted_bytes < least_bytes
                                ? "4 MiB"
                                : fmt::format("{:.4g} times the memory of the smallest row",
                                              study_.max_memory_ratio);
        }
        return limits;
    }
    double most_bytes_of_all() const { return study_.max_memory_gib * 1024 * 1024 * 1024; }

    /// Why voxels miss their goal, and the limit that ended the search; empty where not.
    struct Chosen {
        std::string shortfall, stopped;
    };
    /// Chooses the voxels for equal_delta or equal_memory.
    Chosen choose_voxels(Case& c, const Workload& workload, const ReferenceProbes& probes,
                         const RowLimits& limits) {
        if (!c.equal_delta && !c.equal_memory) return {};
        std::string stopped;
        const EqualSetting found = find_equal_setting(
            c, prepared_.entry(c), workload.domain.edges().maxCoeff(), [&](const Case& trial) {
                if (limits.growth.is_late()) {
                    stopped = "at " + limits.time;
                    refuse("stopped {}", stopped);
                }
                const auto space = make_and_fill(study_, trial, rows_, workload, {}, limits).space;
                return Trial{std::max(accuracy(*space, probes.coarse).max,
                                      accuracy(*space, probes.fine).max),
                             static_cast<double>(space->footprint().bytes_total())};
            });
        c = found.setting;
        return {found.shortfall, stopped};
    }

    /// Makes the structure creation_repeats times, as far as the limit of time allows, with the
    /// same answers, and measures its accuracy.
    void make_and_check(Member& member, std::size_t i, const Workload& workload,
                        const ReferenceProbes& probes, RowLimits limits) {
        const Case& c = member.row.setting;
        const auto places = random_points(workload.domain, study_.access_points, study_.seed);
        Creation creation;
        std::uint64_t expected = 0;
        const Stopwatch time;
        for (int repeat = 0; repeat < study_.creation_repeats; ++repeat) {
            if (repeat > 0 && study_.max_seconds > 0) {
                const double with_this = time.seconds() * (repeat + 1) / repeat;
                if (!creation.stopped.empty() || with_this > study_.max_seconds) break;
                limits.growth.deadline = GrowthLimit{}.deadline;  // for the same answers
            }
            member.space.reset();  // its memory first
            Filled filled = make_and_fill(study_, c, rows_, workload, observer_, limits);
            member.space = std::move(filled.space);
            const std::uint64_t sum = checksum(sample_parallel(*member.space, places));
            if (repeat == 0) {
                creation = filled.creation;
                expected = sum;
            } else {
                append(creation, filled.creation);
                if (sum != expected) {
                    throw std::logic_error("a structure made again gives other answers");
                }
            }
        }
        time_with_known_voxels(c, workload, *member.space, creation);
        notify(observer_.phase_started, "accuracy");
        member.finished.emplace(Finished{finished_before_ + i, study_, c, workload, probes,
                                         *member.space, std::move(creation),
                                         member.space->footprint()});
        Finished& finished = *member.finished;
        try {
            const UntilLate space(*member.space, limit_of_time(1));  // as long again
            finished.accuracy = accuracy(space, probes.coarse);
            finished.accuracy_fine = accuracy(space, probes.fine);
            const std::vector<PointSource> sources = workload.sources.all();
            finished.source_accuracy = source_accuracy(space, sources);
            finished.steepness = steepness(space, workload.domain, sources, study_.seed);
        } catch (const GrowthStopped&) {
            refuse("stopped at {} of measuring its accuracy", limits.time);
        }
        finished.access_batch = finished_before_ + i + 1 - batch_.size();
    }

    /// The time of a grid whose voxels were searched for its target, made again with them.
    void time_with_known_voxels(const Case& c, const Workload& workload, const ControlSpace& space,
                                Creation& creation) {
        const auto recipe = recipe_of(space);
        if (!recipe || !c.target_delta || c.voxel || !prepared_.entry(c).has<VoxelSize>() ||
            !creation.shortfall.empty() || !creation.stopped.empty()) {
            return;
        }
        Case known = c;
        known.voxel = recipe->options.voxel;
        for (std::size_t i = 0; i < creation.insert_s.size(); ++i) {
            const Filled filled = make_and_fill(study_, known, rows_, workload);
            creation.known_s.push_back(filled.creation.insert_s.front() +
                                       filled.creation.gradation_s.front());
        }
    }

    /// Times the access of all structures of the batch in turns, and completes the rows.
    void finish_batch() {
        std::string error;
        try {
            time_batch();
        } catch (const std::exception& e) {
            error = e.what();
        }
        for (Member& member : batch_) {
            if (member.row.error.empty()) member.row.error = error;
            if (member.row.error.empty()) {
                for (const Measure& measure : rows_.measures) {
                    member.row.values[measure.key] = measure.value(*member.finished);
                }
            }
            notify(observer_.case_finished, std::as_const(member.row));
        }
        batch_.clear();
    }

    void time_batch() {
        std::vector<Member*> timed;
        std::vector<const ControlSpace*> spaces;
        for (Member& member : batch_) {
            if (!member.space) continue;
            timed.push_back(&member);
            spaces.push_back(member.space.get());
        }
        if (timed.empty()) return;
        notify(observer_.phase_started, "access");
        const Stopwatch time;
        const Finished& any = *timed.front()->finished;
        const auto places = random_points(any.workload.domain, study_.access_points, study_.seed);
        constexpr double shortest_s = 0.005;
        const double most_s = study_.max_seconds > 0 ? study_.max_seconds / kinds_of_access
                                                     : std::numeric_limits<double>::infinity();
        const auto measure = [&](AccessTime Finished::*result, std::span<const Point> x,
                                 AccessQuery query) {
            auto times = access_times(spaces, x, study_.access_repeats, query, shortest_s, most_s);
            for (std::size_t i = 0; i < timed.size(); ++i) {
                (*timed[i]->finished).*result = std::move(times[i]);
            }
        };
        const Answers answers = any.answers();
        measure(&Finished::access_random, places, {answers});
        measure(&Finished::access_grid, any.probes.coarse.points, {answers});
        measure(&Finished::access_near, any.probes.near, {answers});
        measure(&Finished::access_single, places, {answers, Calls::each});
        measure(&Finished::access_walk, any.probes.walk, {answers, Calls::cursor});
        if (answers == Answers::lengths) {
            measure(&Finished::access_metric_random, places, {Answers::metrics});
            measure(&Finished::access_metric_single, places, {Answers::metrics, Calls::each});
        }
        const double each = time.seconds() / static_cast<double>(timed.size());
        for (Member* member : timed) member->row.seconds += each;
    }

    const PreparedStudy& prepared_;
    const Study& study_;
    const StudyRows& rows_;
    std::size_t finished_before_;
    const StudyObserver& observer_;
    /// By the first case that needs them.
    std::vector<std::pair<std::size_t, std::unique_ptr<ReferenceProbes>>> probes_;
    std::list<Member> batch_;  // a Finished refers to its row
    /// Bytes of the smallest structure that was not stopped, of those that share probes.
    double smallest_ = std::numeric_limits<double>::infinity();
};

}  // namespace

bool share_probes(const Case& a, const Case& b) {
    return a.sources == b.sources && a.reference == b.reference && a.g_r == b.g_r;
}

const CatalogueEntry& entry_of(const Case& c, std::span<const CatalogueEntry> catalogue) {
    return *find_entry(catalogue, c.structure);
}

PreparedStudy::PreparedStudy(Study study, const StudyRows& rows, const FileReaders& readers,
                             std::size_t finished)
    : study_(std::move(study)), rows_(rows), finished_(finished), cases_(expand(study_, rows)) {
    cases_.erase(cases_.begin(), cases_.begin() + static_cast<std::ptrdiff_t>(finished));
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        const Case& c = cases_[i];
        const bool known = std::ranges::any_of(
            sources_, [&](const SharedSources& shared) { return shared.choice == c.sources; });
        if (!known) sources_.push_back({c.sources, make_workload(study_, c.sources, readers), i});
        SharedSources& shared = sources_of(c);
        shared.last_use = i;
        source_counts_.push_back(shared.workload.sources.size());
        space_options(study_, c, shared.workload, rows_.parameters);
    }
}

const CatalogueEntry& PreparedStudy::entry(const Case& c) const {
    return entry_of(c, rows_.structures);
}

const PreparedStudy::SharedSources& PreparedStudy::sources_of(const Case& c) const {
    return *std::ranges::find(sources_, c.sources, &SharedSources::choice);
}

PreparedStudy::SharedSources& PreparedStudy::sources_of(const Case& c) {
    return const_cast<SharedSources&>(std::as_const(*this).sources_of(c));
}

void PreparedStudy::run(const StudyObserver& observer) && {
    Runner(*this, finished_, observer).run([this](std::size_t i) {
        SharedSources& shared = sources_of(cases_[i]);
        if (shared.last_use == i) shared.workload.sources = {};
    });
}

std::vector<Row> PreparedStudy::run() && {
    std::vector<Row> rows;
    StudyObserver observer;
    observer.case_finished = [&](const Row& row) { rows.push_back(row); };
    std::move(*this).run(observer);
    return rows;
}

}  // namespace controlspace

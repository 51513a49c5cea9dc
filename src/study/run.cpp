#include "study/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/space/sample_parallel.h"
#include "study/equal_setting.h"

namespace controlspace {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Callback, class... Arguments>
void tell(const std::function<Callback>& callback, const Arguments&... arguments) {
    if (callback) callback(arguments...);
}

/// Probes that are needed again by later cases.
class ProbeCache {
public:
    explicit ProbeCache(std::span<const Case> cases) : cases_(cases) {}

    /// Probes of case `i`, made by `make` where they are not at hand.
    template <class Make>
    const ReferenceProbes& get(std::size_t i, Make&& make) {
        for (const Entry& entry : entries_) {
            if (share_probes(cases_[entry.first_use], cases_[i])) return *entry.probes;
        }
        entries_.push_back({i, std::make_unique<ReferenceProbes>(make())});
        return *entries_.back().probes;
    }

    /// Frees what no case after `i` needs.
    void drop_after(std::size_t i) {
        std::erase_if(entries_, [&](const Entry& entry) {
            const auto later = cases_.subspan(i + 1);
            return std::none_of(later.begin(), later.end(), [&](const Case& c) {
                return share_probes(cases_[entry.first_use], c);
            });
        });
    }

private:
    struct Entry {
        std::size_t first_use;
        std::unique_ptr<ReferenceProbes> probes;
    };
    std::span<const Case> cases_;
    std::vector<Entry> entries_;
};

/// A field is followed by adaptation; without a target for it only what keeps its elements can be.
void require_follows(const Case& c, const CatalogueEntry& entry) {
    if (c.target_delta || !entry.has<SourceLeaves>()) {
        return;
    }
    throw InputError("an analytic field is followed by adaptation: set target_delta, for trees");
}

void follow_at_nodes(NodeBuilder& builder, const ControlSpace& field) {
    ControlNodes nodes = builder.control_nodes(Neighbourhood::faces);
    sample_parallel(field, positions(nodes.graph), nodes.metrics);
    builder.assign(nodes.metrics);
}

}  // namespace

bool share_probes(const Case& a, const Case& b) {
    return a.sources == b.sources && a.reference == b.reference && a.g_r == b.g_r;
}

const CatalogueEntry& entry_of(const Case& c, std::span<const CatalogueEntry> catalogue) {
    return *find_entry(catalogue, c.structure);
}

std::unique_ptr<ControlSpaceBuilder> make_and_fill(const Study& study, const Case& c,
                                                   const CatalogueEntry& entry,
                                                   const Workload& workload, Measures& m,
                                                   const StudyObserver& observer) {
    if (c.target_delta || has_field(c.sources)) {
        require_follows(c, entry);
        tell(observer.phase_started, "adaptation");
        AdaptationGoal goal{workload.sources, workload.field.field, c.g_r};
        if (c.target_delta) goal.target = *c.target_delta;
        const auto start = std::chrono::steady_clock::now();
        auto builder = entry.make(space_options(study, c, workload));
        const AdaptationReport report = builder->adapt(goal);
        m.insert_s = seconds_since(start);
        if (const auto nodes = control_nodes(*builder->build(), Neighbourhood::faces)) {
            m.gradation.largest_ratio_left =
                largest_gradation(nodes->graph, nodes->metrics, GradationLaw::cone);
        }
        if (c.target_delta) {
            m.footprint.remark =
                fmt::format("δ {:.4g} reached{}{}", report.reached,
                            report.shortfall.empty() ? "" : "; ", report.shortfall);
        }
        return builder;
    }
    tell(observer.phase_started, "insertion");
    auto start = std::chrono::steady_clock::now();
    auto builder = entry.make(space_options(study, c, workload));
    m.sources_inserted = builder->insert(std::span<const PointSource>(workload.sources)).inserted;
    m.insert_s = seconds_since(start);

    tell(observer.phase_started, "gradation");
    start = std::chrono::steady_clock::now();
    m.gradation = builder->grade(
        {.law = c.law, .schedule = c.schedule, .ratio = c.g_r, .neighbourhood = c.neighbourhood});
    m.gradation_s = seconds_since(start);
    if (c.node_values == NodeValues::exact) {
        follow_at_nodes(dynamic_cast<NodeBuilder&>(*builder), *make_reference(study, c, workload));
    }
    return builder;
}

std::unique_ptr<ControlSpace> finish(ControlSpaceBuilder& builder, const Case& c) {
    if (c.frozen == Frozen::no) return builder.build();
    return builder.build(
        {.precision = c.frozen == Frozen::floats ? Precision::floats : Precision::doubles});
}

/// Chooses the voxels of a case that asks for it, and says in the row if they fall short.
std::string choose_equal_setting(const Study& study, Case& c, const CatalogueEntry& entry,
                                 const Workload& workload, const ReferenceProbes& probes) {
    if (!c.equal_delta && !c.equal_memory) return "";
    const double longest_edge = workload.domain.edges().maxCoeff();
    const EqualSetting found =
        find_equal_setting(c, entry, longest_edge, workload.finest_length, [&](const Case& trial) {
            Measures ignored;
            const auto space =
                finish(*make_and_fill(study, trial, entry, workload, ignored, {}), trial);
            return Trial{accuracy(*space, probes.coarse).max,
                         static_cast<double>(space->footprint().bytes_total())};
        });
    c = found.setting;
    return found.shortfall;
}

Measures run_case(const Study& study, const Case& c, const CatalogueEntry& entry,
                  const Workload& workload, const ReferenceProbes& probes,
                  const StudyObserver& observer) {
    Measures m;
    const auto space = finish(*make_and_fill(study, c, entry, workload, m, observer), c);
    const std::string remark = std::move(m.footprint.remark);
    m.footprint = space->footprint();
    if (!remark.empty()) m.footprint.remark = remark;

    tell(observer.phase_started, "access");
    const auto random = random_points(workload.domain, study.access_points, study.seed);
    m.access_random = access_time(*space, random, study.access_repeats);
    m.access_grid = access_time(*space, probes.coarse.points, study.access_repeats);

    tell(observer.phase_started, "accuracy");
    m.accuracy = accuracy(*space, probes.coarse);
    m.accuracy_fine = accuracy(*space, probes.fine);
    m.source_accuracy = source_accuracy(*space, workload.sources);
    return m;
}

PreparedStudy::PreparedStudy(Study study, std::span<const CatalogueEntry> catalogue,
                             const FileReaders& readers, std::size_t finished)
    : study_(std::move(study)), catalogue_(catalogue), cases_(expand(study_, catalogue)) {
    cases_.erase(cases_.begin(), cases_.begin() + static_cast<std::ptrdiff_t>(finished));
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        const Case& c = cases_[i];
        const bool known =
            std::any_of(sources_.begin(), sources_.end(),
                        [&](const SharedSources& shared) { return shared.choice == c.sources; });
        if (!known) sources_.push_back({c.sources, make_workload(study_, c.sources, readers), i});
        SharedSources& shared = sources_of(c);
        shared.last_use = i;
        source_counts_.push_back(shared.workload.sources.size());
        space_options(study_, c, shared.workload);
    }
}

const CatalogueEntry& PreparedStudy::entry(const Case& c) const { return entry_of(c, catalogue_); }

const PreparedStudy::SharedSources& PreparedStudy::sources_of(const Case& c) const {
    return *std::find_if(sources_.begin(), sources_.end(),
                         [&](const SharedSources& shared) { return shared.choice == c.sources; });
}

PreparedStudy::SharedSources& PreparedStudy::sources_of(const Case& c) {
    return const_cast<SharedSources&>(std::as_const(*this).sources_of(c));
}

void PreparedStudy::run(const StudyObserver& observer) && {
    ProbeCache probe_cache(cases_);
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        const Case& c = cases_[i];
        SharedSources& shared = sources_of(c);
        tell(observer.case_started, c);
        Row row{c, shared.workload.sources.size(), std::nullopt, {}};
        try {
            const ReferenceProbes& probes = probe_cache.get(i, [&] {
                tell(observer.phase_started, "reference field");
                return make_reference_probes(study_, c, shared.workload);
            });
            const CatalogueEntry& entry = this->entry(c);
            const std::string shortfall =
                choose_equal_setting(study_, row.setting, entry, shared.workload, probes);
            row.measures = run_case(study_, row.setting, entry, shared.workload, probes, observer);
            std::string& remark = row.measures->footprint.remark;
            remark += (remark.empty() || shortfall.empty() ? "" : "; ") + shortfall;
        } catch (const std::bad_alloc&) {
            row.error = "out of memory: lower max_memory, or raise tau";
        } catch (const std::exception& error) {
            row.error = error.what();
        }
        probe_cache.drop_after(i);
        if (shared.last_use == i) shared.workload.sources = {};
        tell(observer.case_finished, row);
    }
}

}  // namespace controlspace

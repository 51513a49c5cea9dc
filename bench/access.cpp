// SPDX-License-Identifier: Apache-2.0
// Access time of a batch, on one thread: every structure on the paper's sphere, in several orders
// of places, beside that of lengths place by place, alone and by a cursor, and the limit of a
// batch: a gather of the same metrics with precomputed indices, or of eight that are blended.
//
// Names: access/STRUCTURE/WORK/ORDER, and so with length, cursor and limit. STRUCTURE is a row of
// the catalogue, -s_G with that split, -doubles, -floats, -log16 and -log8 in the forms that are
// only read, -fine a grid whose voxels are as small as the octree's smallest leaf. Counters: bytes
// for a leaf (for a cell of a grid). One WORK at a time (--benchmark_filter) keeps memory low.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/metric/blend.h"
#include "geometry/point_order.h"
#include "works.h"

using namespace controlspace;

namespace {

/// A structure of the table and how it is made for a work.
struct Row {
    std::string name;
    std::function<std::unique_ptr<ControlSpaceBuilder>(const Work&)> make = {};
    bool has_limit = false;
    std::optional<Precision> frozen = {};  ///< the row before it that is not, in that form
};

const CatalogueEntry& entry_named(const std::string& id) {
    const auto all = structures();
    return *std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.id == id; });
}

// As long as an edge of the octree's smallest leaf.
std::unique_ptr<ControlSpaceBuilder> as_fine_as_octree(const CatalogueEntry& grid,
                                                       const Work& work) {
    const int depth = graded(entry_named("K_oL"), work)->build()->footprint().depth;
    const double voxel = bench_domain().edges().x() / static_cast<double>(1 << depth);
    return graded(grid, work, SplitRule::middle, voxel);
}

bool is_blended(const std::string& id) { return id == "K_V" || id == "K_oV"; }

// All structures on the first work; on the others the paper's trees, and the plain grids where
// making them takes seconds.
std::vector<Row> rows_of(const Work& work) {
    const bool first = work.name == works().front().name;
    std::vector<Row> rows;
    for (const CatalogueEntry& entry : structures()) {
        const bool is_tree = entry.family == "trees";
        const bool is_plain_grid =
            entry.id.starts_with("uniform-") || entry.id.starts_with("openvdb-uniform-");
        const bool is_soon_made = work.tau == 1 && work.sampling.s_n == 1;
        if (!first && !is_tree && !(is_plain_grid && is_soon_made)) continue;
        const bool has_limit = is_tree && entry.order < 2;
        rows.push_back({entry.id, [&](const Work& w) { return graded(entry, w); }, has_limit});
        if (entry.has<CompactForm>()) {
            rows.push_back({.name = entry.id + "-doubles", .frozen = Precision::doubles});
            rows.push_back({.name = entry.id + "-floats", .frozen = Precision::floats});
            if (work.sampling.s_n == 1) {  // isotropic
                rows.push_back({.name = entry.id + "-log16", .frozen = Precision::log16});
                rows.push_back({.name = entry.id + "-log8", .frozen = Precision::log8});
            }
        }
        if (first && entry.id == "K_L") {
            const auto make = [&](const Work& w) { return graded(entry, w, SplitRule::golden); };
            rows.push_back({entry.id + "-s_G", make, has_limit});
        }
        if (first && is_plain_grid && entry.order == 0) {
            const auto make = [&](const Work& w) { return as_fine_as_octree(entry, w); };
            rows.push_back({entry.id + "-fine", make});
        }
    }
    return rows;
}

/// Numbers of the control nodes at given places, which must be such nodes'.
class NodesAt {
public:
    explicit NodesAt(const ControlNodes& nodes) {
        const std::vector<Point> x = positions(nodes.graph);
        for (NodeIndex i = 0; i < x.size(); ++i) numbers_[x[i]] = i;
    }
    NodeIndex operator()(const Point& x) const { return numbers_.at(x); }

private:
    std::map<Point, NodeIndex, decltype(&precedes)> numbers_{precedes};
};

/// What governs each place of a batch: one metric, or eight and their weights.
struct Governing {
    struct Eight {
        std::array<NodeIndex, 8> nodes;
        std::array<double, 8> weights;
    };
    std::vector<NodeIndex> one;
    std::vector<Eight> eight;
};

Governing governing(const ControlSpace& space, const NodesAt& at, const std::vector<Point>& x,
                    bool blended) {
    Governing found;
    for (const Point& p : x) {
        const Box box = *space.cell_at(p);
        if (!blended) {
            found.one.push_back(at(box.centre()));
            continue;
        }
        Governing::Eight& eight = found.eight.emplace_back();
        eight.weights = corner_weights((p - box.low).cwiseQuotient(divisible_edges(box)));
        for (int c = 0; c < 8; ++c) eight.nodes[static_cast<std::size_t>(c)] = at(corner(box, c));
    }
    return found;
}

/// All benchmarks of a work share its structures and places, made by the first that runs.
class Prepared {
public:
    explicit Prepared(const Work& work) : work_(work), rows_(rows_of(work)) {}

    const std::vector<Row>& rows() const { return rows_; }
    void make() {
        if (!spaces_.empty()) return;
        std::unique_ptr<ControlSpaceBuilder> builder;
        for (const Row& row : rows_) {
            if (!row.frozen) builder = row.make(work_);
            spaces_[row.name] = builder->build({.precision = row.frozen});
        }
        for (const auto& [order, name] : orders()) {
            places_[name] = places(order, *spaces_.at("K_oV"));
        }
        for (const Row& row : rows_) {
            if (!row.has_limit) continue;
            const ControlSpace& space = *spaces_.at(row.name);
            ControlNodes nodes = control_nodes(space, Neighbourhood::faces).value();
            const NodesAt at(nodes);
            for (const auto& [name, x] : places_) {
                governing_[row.name + name] = governing(space, at, x, is_blended(row.name));
            }
            metrics_[row.name] = std::move(nodes.metrics);
        }
    }
    const ControlSpace& space(const std::string& row) const { return *spaces_.at(row); }
    const std::vector<Point>& places_in(const std::string& order) const {
        return places_.at(order);
    }
    const std::vector<Metric>& metrics(const std::string& row) const { return metrics_.at(row); }
    const Governing& governing_at(const std::string& row, const std::string& order) const {
        return governing_.at(row + order);
    }

private:
    const Work& work_;
    std::vector<Row> rows_;
    std::map<std::string, std::unique_ptr<ControlSpace>> spaces_;
    std::map<std::string, std::vector<Point>> places_;
    std::map<std::string, std::vector<Metric>> metrics_;
    std::map<std::string, Governing> governing_;
};

template <class Answer>
void time_batch(benchmark::State& state, std::size_t n, Answer&& answer) {
    std::vector<Metric> out(n);
    answer(out);  // so that caches contain the data, whatever was timed before
    for (auto _ : state) {
        answer(out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_queries(state, n);
}

void access(benchmark::State& state, const ControlSpace& space, const std::vector<Point>& x) {
    time_batch(state, x.size(), [&](std::vector<Metric>& out) { space.sample(x, out); });
    const Footprint f = space.footprint();
    const auto each = static_cast<double>(f.cells);
    state.counters["cells"] = each;
    state.counters["payload"] = static_cast<double>(f.bytes_payload) / each;
    state.counters["topology"] = static_cast<double>(f.bytes_topology) / each;
    state.counters["auxiliary"] = static_cast<double>(f.bytes_auxiliary) / each;
}

void length(benchmark::State& state, const ControlSpace& space, const std::vector<Point>& x) {
    for (auto _ : state) {
        for (const Point& p : x) benchmark::DoNotOptimize(space.length_at(p));
    }
    count_queries(state, x.size());
}

void cursor(benchmark::State& state, const ControlSpace& space, const std::vector<Point>& x) {
    const std::unique_ptr<Cursor> cursor = space.cursor();
    for (auto _ : state) {
        for (const Point& p : x) benchmark::DoNotOptimize(cursor->length_at(p));
    }
    count_queries(state, x.size());
}

void limit(benchmark::State& state, const std::vector<Metric>& metrics, const Governing& found) {
    if (!found.one.empty()) {
        time_batch(state, found.one.size(), [&](std::vector<Metric>& out) {
            for (std::size_t i = 0; i < out.size(); ++i) out[i] = metrics[found.one[i]];
        });
        return;
    }
    time_batch(state, found.eight.size(), [&](std::vector<Metric>& out) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            const Governing::Eight& f = found.eight[i];
            out[i] = blend_lengths(
                f.weights, [&](std::size_t c) -> const Metric& { return metrics[f.nodes[c]]; });
        }
    });
}

void add(const Work& work) {
    const auto prepared = std::make_shared<Prepared>(work);
    for (const Row& row : prepared->rows()) {
        for (const auto& named : orders()) {
            const std::string order = named.name;
            const std::string name = row.name + "/" + work.name + "/" + order;
            const std::string id = row.name;
            benchmark::RegisterBenchmark(("access/" + name).c_str(), [=](benchmark::State& state) {
                prepared->make();
                access(state, prepared->space(id), prepared->places_in(order));
            });
            benchmark::RegisterBenchmark(("length/" + name).c_str(), [=](benchmark::State& state) {
                prepared->make();
                length(state, prepared->space(id), prepared->places_in(order));
            });
            benchmark::RegisterBenchmark(("cursor/" + name).c_str(), [=](benchmark::State& state) {
                prepared->make();
                cursor(state, prepared->space(id), prepared->places_in(order));
            });
            if (!row.has_limit) continue;
            benchmark::RegisterBenchmark(("limit/" + name).c_str(), [=](benchmark::State& state) {
                prepared->make();
                limit(state, prepared->metrics(id), prepared->governing_at(id, order));
            });
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    for (const Work& work : works()) add(work);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}

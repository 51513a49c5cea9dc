// Access time: every structure of the catalogue on the paper's sphere, in several orders of places,
// beside the limit: a gather of the same metrics by numbers known beforehand. One thread.
//
// Names: STRUCTURE/WORK/ORDER and limit-gather, limit-blend of a structure. Orders: uniformly
// random, grid, where elements are (drawn with density 1 / det M, random or along a Morton curve),
// and random walks of half an element's length a step.
#include <benchmark/benchmark.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "baselines/catalogue.h"
#include "geometry/random_fractions.h"
#include "measure/access_time.h"
#include "measure/accuracy.h"
#include "metric/blend.h"
#include "sources/sampled_surfaces.h"
#include "spaces/vertex_values.h"

using namespace controlspace;

namespace {

constexpr std::size_t queries = 100'000;
const Box domain{Point::Constant(-1), Point::Constant(1)};

struct Work {
    std::string name;
    double tau;
    SphereSampling sampling;
};
const Work works[] = {{"rho:1/tau:1", 1, {}},
                      {"rho:1/tau:0.2", 0.2, {}},
                      {"rho:0.2/tau:1", 1, {.rho = 0.2}},
                      {"layered/tau:1", 1, {.s_a = 4, .s_n = 0.25}}};

enum class Order { random, grid, elements, morton, walk };
constexpr std::pair<Order, const char*> orders[] = {{Order::random, "random"},
                                                    {Order::grid, "grid"},
                                                    {Order::elements, "elements"},
                                                    {Order::morton, "morton"},
                                                    {Order::walk, "walk"}};

std::unique_ptr<ControlSpace> graded(const CatalogueEntry& entry, SplitRule split,
                                     const Work& work) {
    const std::vector<PointSource> sources = sample_sphere(work.sampling);
    SpaceOptions options;
    options.domain = domain;
    options.split = split;
    options.l_min = work.tau;
    options.finest_length = finest_length(sources);
    auto space = entry.make(options);
    space->insert(sources);
    space->grade({.ratio = options.ratio});
    return space;
}

// Half the mean length of an element there.
double half_step(const ControlSpace& field, const Point& x) {
    return 0.5 * mean_length(sample_at(field, x));
}

std::vector<Point> walk(const ControlSpace& field) {
    RandomFractions fraction(3);
    std::vector<Point> x{Point(0.8, 0.1, 0.1)};
    while (x.size() < queries) {
        const Vector way(fraction() - 0.5, fraction() - 0.5, fraction() - 0.5);
        const Point next = x.back() + half_step(field, x.back()) * way.normalized();
        x.push_back(domain.contains(next) ? next : x.back());
    }
    return x;
}

// With density 1 / det M: a cell of a fine grid by its share, then a place in it.
std::vector<Point> where_elements_are(const ControlSpace& field) {
    constexpr int n = 128;
    const std::vector<Point> cells = cell_centres(domain, n);
    std::vector<Metric> metrics(cells.size());
    field.sample(cells, metrics);
    std::vector<double> sums(cells.size());
    double sum = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        sums[i] = sum += 1 / metrics[i].matrix().determinant();
    }
    RandomFractions fraction(2);
    std::vector<Point> x(queries);
    for (Point& p : x) {
        const auto drawn = std::upper_bound(sums.begin(), sums.end() - 1, fraction() * sum);
        const Vector offset(fraction() - 0.5, fraction() - 0.5, fraction() - 0.5);
        p = cells[static_cast<std::size_t>(drawn - sums.begin())] +
            offset.cwiseProduct(domain.edges()) / n;
    }
    return x;
}

std::uint32_t morton_code(const Point& x) {
    std::uint32_t code = 0;
    for (Axis a = 0; a < 3; ++a) {
        const auto c = static_cast<std::uint32_t>(1024 * (x[a] - domain.low[a]) /
                                                  (domain.high[a] - domain.low[a]));
        for (int bit = 0; bit < 10; ++bit) code |= (c >> bit & 1u) << (3 * bit + a);
    }
    return code;
}

/// The places of an order; `field` says how long elements are.
std::vector<Point> places(Order order, const ControlSpace& field) {
    if (order == Order::random) return random_points(domain, queries, 1);
    if (order == Order::grid) return cell_centres(domain, 47);
    if (order == Order::walk) return walk(field);
    std::vector<Point> x = where_elements_are(field);
    if (order == Order::morton) {
        std::sort(x.begin(), x.end(),
                  [](const Point& p, const Point& q) { return morton_code(p) < morton_code(q); });
    }
    return x;
}

/// Numbers of the control nodes at given places, which must be such nodes'.
class NodesAt {
public:
    explicit NodesAt(const ControlNodes& nodes) {
        std::visit(
            [&](const auto& graph) {
                for (NodeIndex i = 0; i < graph.size(); ++i) numbers_[graph.position(i)] = i;
            },
            nodes.graph);
    }
    NodeIndex operator()(const Point& x) const { return numbers_.at(x); }

private:
    struct Hash {
        std::size_t operator()(const Point& x) const {
            std::size_t sum = 0;
            for (Axis a = 0; a < 3; ++a) sum = sum * 0x9e3779b97f4a7c15 + std::hash<double>()(x[a]);
            return sum ^ sum >> 29;
        }
    };
    std::unordered_map<Point, NodeIndex, Hash> numbers_;
};

void per_query(benchmark::State& state, std::size_t n) {
    state.counters["per_query"] =
        benchmark::Counter(static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate |
                                                       benchmark::Counter::kInvert);
}

void read(benchmark::State& state, const ControlSpace& space, const std::vector<Point>& x) {
    std::vector<Metric> out(x.size());
    for (auto _ : state) {
        space.sample(x, out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    per_query(state, x.size());
}

// One metric a query, or eight that are blended: what is left if finding it costs nothing.
void limit(benchmark::State& state, const ControlSpace& space, const std::vector<Point>& x,
           bool blended) {
    const ControlNodes nodes = space.control_nodes(Neighbourhood::faces);
    const NodesAt at(nodes);
    std::vector<Metric> out(x.size());
    if (!blended) {
        std::vector<NodeIndex> found;
        for (const Point& p : x) found.push_back(at(space.element_at(p).centre()));
        for (auto _ : state) {
            for (std::size_t i = 0; i < x.size(); ++i) out[i] = nodes.metrics[found[i]];
            benchmark::DoNotOptimize(out.data());
            benchmark::ClobberMemory();
        }
    } else {
        struct Corners {
            std::array<NodeIndex, 8> nodes;
            std::array<double, 8> weights;
        };
        std::vector<Corners> found(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Box box = space.element_at(x[i]);
            found[i].weights = corner_weights(box, x[i]);
            for (int c = 0; c < 8; ++c) {
                found[i].nodes[static_cast<std::size_t>(c)] = at(corner(box, c));
            }
        }
        for (auto _ : state) {
            for (std::size_t i = 0; i < x.size(); ++i) {
                const Corners& f = found[i];
                out[i] = blend_lengths(f.weights, [&](std::size_t c) -> const Metric& {
                    return nodes.metrics[f.nodes[c]];
                });
            }
            benchmark::DoNotOptimize(out.data());
            benchmark::ClobberMemory();
        }
    }
    per_query(state, x.size());
}

/// All benchmarks of a work share its structures and places.
void add(const Work& work) {
    struct Prepared {
        std::vector<std::pair<std::string, std::unique_ptr<ControlSpace>>> spaces;
        std::vector<std::vector<Point>> places;
    };
    // Filled by the first benchmark that runs.
    const auto prepared = std::make_shared<Prepared>();
    const auto prepare = [&work, prepared] {
        if (!prepared->places.empty()) return;
        for (const CatalogueEntry& entry : structures()) {
            prepared->spaces.emplace_back(entry.id, graded(entry, SplitRule::middle, work));
        }
        const auto& field =
            *std::find_if(prepared->spaces.begin(), prepared->spaces.end(), [](const auto& s) {
                 return s.first == "K_oV";
             })->second;
        for (const auto& [order, name] : orders) prepared->places.push_back(places(order, field));
    };
    for (std::size_t s = 0; s < structures().size(); ++s) {
        const CatalogueEntry& entry = structures()[s];
        for (std::size_t o = 0; o < std::size(orders); ++o) {
            const std::string rest = "/" + work.name + "/" + orders[o].second;
            benchmark::RegisterBenchmark((entry.id + rest).c_str(), [=](benchmark::State& state) {
                prepare();
                read(state, *prepared->spaces[s].second, prepared->places[o]);
            });
            const bool blended = entry.id == "K_V" || entry.id == "K_oV";
            if (!blended && entry.id != "K_L" && entry.id != "K_oL") continue;
            const std::string name = entry.id + (blended ? " limit-blend" : " limit-gather") + rest;
            benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
                prepare();
                limit(state, *prepared->spaces[s].second, prepared->places[o], blended);
            });
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    for (const Work& work : works) add(work);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}

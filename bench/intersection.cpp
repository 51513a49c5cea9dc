// SPDX-License-Identifier: Apache-2.0
// The order-free intersection of 12 metrics to a duality gap of 1e-6, on one thread: from nothing
// ("cold"), and from an answer whose lengths are off by half a percent ("warm"). Names:
// cold/KIND/ANISOTROPY and warm/KIND/ANISOTROPY; counters are the Newton steps of an intersection,
// and the largest duality gap. "drawn": random frames, sizes from 1 to 2; "layers": all touch the
// answer.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "controlspace/metric/order_free_intersection.h"

using namespace controlspace;

namespace {

constexpr std::size_t metrics_each = 12;
constexpr std::size_t sets = 200;

struct Problem {
    std::vector<Metric> metrics;
    Eigen::Matrix3d near;  ///< a factor of an answer that is off by half a percent
};

class Draw {
public:
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    Eigen::Matrix3d matrix() {
        return Eigen::Matrix3d::NullaryExpr([&] { return normal_(engine_); });
    }
    Metric drawn(double anisotropy) {
        const double size = uniform(1, 2);
        const Eigen::Matrix3d m = matrix();
        const EigenFrame frame = eigen_frame(Metric::from_matrix(m * m.transpose()));
        return metric_from_frame(
            {size, size * anisotropy, size * std::pow(anisotropy, uniform(0, 1))},
            frame.directions);
    }
    Metric layer(double anisotropy) {
        return layer_metric(Vector(matrix().col(0)).normalized(), 1, anisotropy);
    }

private:
    std::mt19937 engine_{1};
    std::normal_distribution<double> normal_;
};

std::vector<Problem> problems(bool of_layers, double anisotropy) {
    constexpr double off = 0.005;
    Draw draw;
    std::vector<Problem> all(sets);
    for (auto& [metrics, near] : all) {
        for (std::size_t i = 0; i < metrics_each; ++i) {
            metrics.push_back(of_layers ? draw.layer(anisotropy) : draw.drawn(anisotropy));
        }
        Eigen::Matrix3d change = draw.matrix();
        change = 0.5 * (change + change.transpose()).eval();
        near = order_free_intersection(metrics).factor *
               (Eigen::Matrix3d::Identity() + off / change.norm() * change);
    }
    return all;
}

void intersect(benchmark::State& state, const std::vector<Problem>& all, bool warm) {
    double steps = 0;
    double gap = 0;
    const auto intersect_all = [&] {
        for (const auto& [metrics, near] : all) {
            const auto answer = order_free_intersection(metrics, 1e-6, warm ? &near : nullptr);
            benchmark::DoNotOptimize(answer);
            steps += answer.steps;
            gap = std::max(gap, answer.gap);
        }
    };
    for (auto _ : state) intersect_all();
    const auto count = static_cast<double>(all.size());
    state.counters["steps"] = steps / count / static_cast<double>(state.iterations());
    state.counters["gap"] = gap;
    state.counters["per_intersection"] = benchmark::Counter(
        count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
    for (const bool warm : {false, true}) {
        for (const bool of_layers : {false, true}) {
            for (const int anisotropy : {4, 100, 10000, 1000000}) {
                const std::string name = std::string(warm ? "warm" : "cold") +
                                         (of_layers ? "/layers/" : "/drawn/") +
                                         std::to_string(anisotropy);
                benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
                    intersect(state, problems(of_layers, anisotropy), warm);
                })->Unit(benchmark::kMicrosecond);
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}

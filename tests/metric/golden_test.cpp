// SPDX-License-Identifier: Apache-2.0
// Golden numbers of the metric algebra: data/golden/metric_golden.csv, made in 60-digit arithmetic
// by the script beside it.

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "data_folder.h"
#include "metric/draw.h"

namespace controlspace::golden_test {
namespace {

struct Golden {
    std::string kind;
    Metric a, b, intersection;
    double nonconformity, riemannian;
    std::array<double, 3> lengths;
    Vector v;
    double metric_length;
};

std::vector<Golden> read_golden() {
    std::ifstream file(data_folder() / "golden/metric_golden.csv");
    std::vector<Golden> rows;
    std::string line;
    std::getline(file, line);  // where the numbers come from
    std::getline(file, line);  // names
    while (std::getline(file, line)) {
        std::istringstream fields(line);
        std::string kind;
        std::getline(fields, kind, ',');
        std::vector<double> x;
        for (std::string field; std::getline(fields, field, ',');) x.push_back(std::stod(field));
        REQUIRE(x.size() == 27);
        const auto metric = [&](std::size_t i) {
            return Metric{x[i], x[i + 1], x[i + 2], x[i + 3], x[i + 4], x[i + 5]};
        };
        rows.push_back({kind,
                        metric(0),
                        metric(6),
                        metric(12),
                        x[18],
                        x[19],
                        {x[20], x[21], x[22]},
                        {x[23], x[24], x[25]},
                        x[26]});
    }
    return rows;
}

}  // namespace

TEST_CASE("golden numbers of the metric algebra") {
    const std::vector<Golden> rows = read_golden();
    REQUIRE(rows.size() == 420);
    for (const Golden& g : rows) {
        const double condition_a = g.lengths[2] / g.lengths[0];
        const auto lengths_b = eigen_frame(g.b).lengths;
        const double condition_b = lengths_b[2] / lengths_b[0];
        const double digits = 1e-14 + 2e-15 * std::max(condition_a, condition_b);
        CAPTURE(g.kind, to_string(g.a), to_string(g.b), digits);

        CHECK(length_difference(intersection(g.a, g.b), g.intersection) < 2 * digits);
        CHECK(length_difference(intersection(g.b, g.a), g.intersection) < 2 * digits);
        CHECK(nonconformity(g.a, g.b) == Approx(g.nonconformity).epsilon(digits).margin(digits));
        CHECK(riemannian_nonconformity(g.a, g.b) ==
              Approx(g.riemannian).epsilon(digits).margin(4 * digits));
        const EigenFrame frame = eigen_frame(g.a);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(frame.lengths[i] == Approx(g.lengths[i]).epsilon(1e-15 * condition_a));
        }
        CHECK(metric_length(g.a, g.v) == Approx(g.metric_length).epsilon(1e-15 * condition_a));
    }
}

}  // namespace controlspace::golden_test

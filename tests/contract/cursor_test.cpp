// SPDX-License-Identifier: Apache-2.0
// Cursors answer as the space does, whatever they remember.
#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "editable_space.h"

namespace controlspace::cursor_test {
namespace {

// Walks in short and long steps, which leave the domain now and then; corners, middles of edges and
// faces of cells on their way, where several leaves meet; and the same shuffled by going far away
// after each step.
std::vector<Point> places_of(const ControlSpace& space) {
    const Box domain = space.domain();
    const Vector beyond = domain.edges() / 8;
    const std::vector<Point> away = random_points(domain, 100, 1);
    const std::vector<Point> ways = random_points({-domain.edges(), domain.edges()}, 100, 2);
    std::vector<Point> places;
    for (const double step : {0.002, 0.02, 0.2}) {
        Point x = domain.centre();
        for (std::size_t i = 0; i < ways.size(); ++i) {
            x = nearest_in({domain.low - beyond, domain.high + beyond}, x + step * ways[i]);
            places.push_back(x);
            const std::optional<Box> cell = space.cell_at(x);
            if (cell && i % 4 == 0) {
                for (int c = 0; c < 27; ++c) {
                    const Vector fraction(c % 3, c / 3 % 3, c / 9);
                    Point at = cell->low;
                    for (Axis a = 0; a < 3; ++a) {
                        if (fraction[a] == 2) at[a] = cell->high[a];
                        if (fraction[a] == 1) at[a] = 0.5 * (cell->low[a] + cell->high[a]);
                    }
                    places.push_back(at);
                }
            }
            if (i % 8 == 0) places.push_back(away[i]);
        }
    }
    for (int c = 0; c < 8; ++c) places.push_back(corner(domain, c));
    return places;
}

void require_same(const ControlSpace& space) {
    const std::vector<Point> places = places_of(space);
    const std::unique_ptr<Cursor> lengths = space.cursor(), metrics = space.cursor(),
                                  both = space.cursor();
    const ThreadCursor in_thread(space);
    std::size_t others = 0;
    for (const Point& x : places) {
        const double length = space.length_at(x);
        const Metric metric = space.metric_at(x);
        const bool same = lengths->length_at(x) == length && metrics->metric_at(x) == metric &&
                          both->metric_at(x) == metric && both->length_at(x) == length &&
                          in_thread.length_at(x) == length && in_thread.metric_at(x) == metric;
        others += same ? 0 : 1;
    }
    CHECK(others == 0);
}

}  // namespace

STRUCTURE_CASE(every_structure, "a cursor answers as the space, in its compact forms too") {
    const Work work = GENERATE(isotropic_sphere(), anisotropic_sphere(), oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto space = work.graded(structure);
    require_same(space->built());
    if (!structure.has<CompactForm>()) return;
    require_same(*space->compact(Precision::doubles));
    require_same(*space->compact(Precision::floats));
    if (!work.isotropic()) return;
    require_same(*space->compact(Precision::log16));
    require_same(*space->compact(Precision::log8));
}

TEST_CASE("a space that comes to lie where another one lay is asked anew, in every thread",
          "[threads]") {
    const CatalogueEntry structure =
        structures_that([](const CatalogueEntry& s) { return s.id == "K_oV"; }).front();
    const Work work = isotropic_sphere();
    const auto ask = [&] {
        const auto fine = editable(structure.make(work.options()));
        fine->insert({Point::Zero(), Metric::isotropic(0.1)});
        const auto coarse = editable(structure.make(work.options()));
        // More at a time than a thread keeps.
        std::vector<std::unique_ptr<ControlSpace>> spaces;
        std::vector<ThreadCursor> cursors;
        std::size_t wrong = 0;
        for (int round = 0; round < 50; ++round) {
            spaces.clear();
            cursors.clear();
            for (int i = 0; i < 6; ++i) {
                spaces.push_back((i + round) % 2 == 0 ? fine->compact(Precision::doubles)
                                                      : coarse->compact(Precision::doubles));
                cursors.emplace_back(*spaces.back());
            }
            for (int again = 0; again < 2; ++again) {
                for (std::size_t i = 0; i < spaces.size(); ++i) {
                    const Point x = Point::Constant(0.001 * static_cast<double>(i));
                    if (cursors[i].length_at(x) != spaces[i]->length_at(x)) ++wrong;
                }
            }
        }
        return wrong;
    };
    std::vector<std::size_t> wrong(4, 1);
    std::vector<std::thread> threads;
    for (std::size_t& w : wrong) threads.emplace_back([&] { w = ask(); });
    for (std::thread& thread : threads) thread.join();
    CHECK(std::ranges::count(wrong, 0u) == 4);
}

}  // namespace controlspace::cursor_test

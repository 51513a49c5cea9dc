// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/split_rule.h"

#include <catch2/catch.hpp>

namespace controlspace::split_rule_test {
namespace {

const Box box{Point(0, 0, 0), Point(4, 2, 1)};

PointSource at(double x, double h) { return {Point(x, 0.5, 0.5), Metric::isotropic(h)}; }

}  // namespace

TEST_CASE("s_L cuts the middle of the axis that is longest in the source's metric") {
    const Subdivision along_x = cut(SplitRule::middle, box, at(1, 0.1), 1);
    CHECK(along_x.cuts == std::array{true, false, false});
    CHECK(along_x.at.x() == 2);
    // Lengths 4/4, 2/0.5 and 1/1: y is the longest in this metric.
    const PointSource stretched{Point(1, 1, 1), {4, 0.5, 1, 0, 0, 0}};
    const Subdivision along_y = cut(SplitRule::middle, box, stretched, 1);
    CHECK(along_y.cuts == std::array{false, true, false});
    CHECK(along_y.at.y() == 1);
}

TEST_CASE("equally long axes are cut z before y before x") {
    const Box cube{Point(0, 0, 0), Point(1, 1, 1)};
    const Box flat{Point(0, 0, 0), Point(1, 1, 0.5)};
    CHECK(cut(SplitRule::middle, cube, at(0.5, 0.1), 1).cuts[2]);
    CHECK(cut(SplitRule::middle, flat, at(0.5, 0.1), 1).cuts[1]);
}

TEST_CASE("s_G cuts at the golden section nearer to the source") {
    CHECK(cut(SplitRule::golden, box, at(1.9, 0.1), 1).at.x() == Approx(4 * 0.38197));
    CHECK(cut(SplitRule::golden, box, at(2.0, 0.1), 1).at.x() == Approx(4 * 0.61803));
    CHECK(cut(SplitRule::golden, box, at(3.9, 0.1), 1).at.x() == Approx(4 * 0.61803));
}

TEST_CASE("s_Gx cuts at exact sections: twice near the middle is as much as once near the end") {
    const double once = cut(SplitRule::exact_golden, box, at(1.9, 0.1), 1).at.x() / 4;
    const double far = cut(SplitRule::exact_golden, box, at(2.0, 0.1), 1).at.x() / 4;
    CHECK(once + far == 1);
    CHECK(far * far == Approx(once).epsilon(1e-15));
    CHECK(once == Approx(0.38197).epsilon(1e-4));
}

TEST_CASE("s_M leaves l_min around the source") {
    // The edge along x is 40 metric lengths; l_min = 2 takes a twentieth of it, 0.2.
    const auto place = [](double x) { return cut(SplitRule::metric, box, at(x, 0.1), 2).at.x(); };
    CHECK(place(0.1) == Approx(0.2));  // at k, near the low face
    CHECK(place(3.9) == Approx(3.8));  // at 1 - k, near the high face
    CHECK(place(1) == Approx(1.1));    // half of l_min beyond the source
    CHECK(place(3) == Approx(2.9));
    CHECK(cut(SplitRule::metric, box, at(1, 1.5), 2).at.x() == 2);  // less than 2 l_min: middle
}

TEST_CASE("children of a subdivision fill the box, and their faces are copies") {
    const Box odd{Point(0.1, 0.2, 0.3), Point(0.7, 1.9, 0.4)};
    for (const Subdivision& s : {octants(odd), halves(odd, 0, 0.3), halves(odd, 2, 0.33)}) {
        double volume = 0;
        for (int c = 0; c < s.children(); ++c) {
            const Box child = s.child(c);
            volume += child.edges().prod();
            for (Axis a = 0; a < 3; ++a) {
                const auto axis = static_cast<std::size_t>(a);
                const double low = s.cuts[axis] && s.side(c, a) == 1 ? s.at[a] : odd.low[a];
                const double high = s.cuts[axis] && s.side(c, a) == 0 ? s.at[a] : odd.high[a];
                CHECK(child.low[a] == low);
                CHECK(child.high[a] == high);
            }
        }
        CHECK(volume == Approx(odd.edges().prod()));
        CHECK(s.is_proper());
    }
    CHECK_FALSE(halves(odd, 0, 0.1).is_proper());
    CHECK_FALSE(halves(odd, 1, 1.9).is_proper());
}

}  // namespace controlspace::split_rule_test

// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/access_time.h"

#include <bit>
#include <catch2/catch.hpp>
#include <chrono>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>

#include "controlspace/error.h"
#include "measure/fake_spaces.h"

namespace controlspace::access_time_test {
namespace {

const Box box{Point(-1, 0, 10), Point(1, 5, 10.5)};

}  // namespace

TEST_CASE("Random points fill the box evenly") {
    constexpr std::size_t n = 80000;
    const auto points = random_points(box, n, 1);
    REQUIRE(points.size() == n);
    std::array<int, 8> octants{};
    for (const Point& p : points) {
        REQUIRE(box.contains(p));
        const Point c = box.centre();
        ++octants[(p.x() > c.x() ? 1u : 0u) + (p.y() > c.y() ? 2u : 0u) +
                  (p.z() > c.z() ? 4u : 0u)];
    }
    // 10000 each, within six standard deviations of the binomial distribution (94).
    for (const int octant : octants) CHECK(std::abs(octant - 10000) < 564);
}

TEST_CASE("Random points depend on the seed and on nothing else") {
    CHECK(random_points(box, 100, 1) == random_points(box, 100, 1));
    CHECK(random_points(box, 100, 1) != random_points(box, 100, 2));
    const auto few = random_points(box, 10, 1);
    const auto many = random_points(box, 100, 1);
    CHECK(std::equal(few.begin(), few.end(), many.begin()));
    CHECK(random_points(box, 0, 1).empty());
    CHECK_THROWS_AS(random_points(box, std::size_t{1} << 40, 1), InputError);
}

TEST_CASE("The checksum sees every bit and the order") {
    const Metric a{1, 2, 3, 0.1, 0.2, 0.3};
    const Metric b{4, 5, 6, 0.4, 0.5, 0.6};
    CHECK(checksum(std::vector{a, b}) == checksum(std::vector{a, b}));
    CHECK(checksum(std::vector{a, b}) != checksum(std::vector{b, a}));
    CHECK(checksum(std::vector{a}) != checksum(std::vector{a, a}));
    CHECK(checksum(std::vector{Metric{1, 2, 3, 0, 0, 0}}) !=
          checksum(std::vector{Metric{1, 2, 3, -0.0, -0.0, 0}}));

    std::set<std::uint64_t> sums{checksum(std::vector{a, b})};
    const auto words = std::bit_cast<std::array<std::uint64_t, 6>>(a);
    for (std::size_t word = 0; word < 6; ++word) {
        for (int bit = 0; bit < 64; ++bit) {
            auto changed = words;
            changed[word] ^= std::uint64_t{1} << bit;
            sums.insert(checksum(std::vector{std::bit_cast<Metric>(changed), b}));
        }
    }
    CHECK(sums.size() == 1 + 6 * 64);
}

TEST_CASE("Access time gives one sample a repeat, and the answers' checksum") {
    const FunctionSpace space([](const Point& p) { return Metric::isotropic(1 + p.norm()); });
    const auto points = random_points(box, 100, 3);
    std::vector<Metric> answers(points.size());
    space.sample(points, answers);
    const AccessTime time = access_time(space, points, 4, 1e-4);
    REQUIRE(time.samples_ns.size() == 4);
    for (const double sample : time.samples_ns) CHECK(sample > 0);
    CHECK(time.checksum == checksum(answers));
}

TEST_CASE("Places are passed to a structure all at once, or one in each call") {
    /// Keeps the largest number of places in a call.
    class Counting final : public ControlSpace {
    public:
        void sample(std::span<const Point> x, std::span<Metric> out) const override {
            most = std::max(most, x.size());
            calls += x.size() == 1 ? 1 : 0;
            std::ranges::fill(out, Metric::isotropic(1));
        }
        mutable std::size_t most = 0, calls = 0;
    };
    const Counting space;
    const ControlSpace* const spaces[] = {&space};
    const auto points = random_points(box, 100, 3);
    const auto times = access_times(spaces, points, 2, {.calls = Calls::each}, 0);
    CHECK(times[0].samples_ns.size() == 2);
    CHECK(space.calls == 2 * points.size());
    CHECK(space.most == points.size());  // the untimed run
    access_times(spaces, points, 2, {}, 0);
    CHECK(space.calls == 2 * points.size());
}

TEST_CASE("Lengths are timed by the calls that return lengths, and give their own checksum") {
    /// Counts each of its calls; `wrong` times the lengths of its metrics.
    class Counting final : public ControlSpace {
    public:
        explicit Counting(double wrong = 1) : wrong_(wrong) {}
        void sample(std::span<const Point> x, std::span<Metric> out) const override {
            for (std::size_t i = 0; i < x.size(); ++i) out[i] = Metric::isotropic(x[i].z());
        }
        void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
            ++batches;
            for (std::size_t i = 0; i < x.size(); ++i) out[i] = wrong_ * x[i].z();
        }
        double length_at(const Point& x) const override {
            ++singles;
            return wrong_ * x.z();
        }
        std::unique_ptr<Cursor> cursor() const override {
            ++cursors;
            return ControlSpace::cursor();
        }
        mutable std::size_t batches = 0, singles = 0, cursors = 0;

    private:
        double wrong_;
    };
    const Counting space;
    const ControlSpace* const spaces[] = {&space};
    const auto points = random_points(box, 100, 3);
    std::vector<double> lengths;
    for (const Point& p : points) lengths.push_back(p.z());
    const auto time = [&](Calls calls) {
        return access_times(spaces, points, 2, {Answers::lengths, calls}, 0).front();
    };
    CHECK(time(Calls::one).checksum == checksum(lengths));
    CHECK(space.batches == 4);
    CHECK(space.singles == 0);
    CHECK(time(Calls::each).checksum == checksum(lengths));
    CHECK(space.batches == 6);
    CHECK(space.singles == 200);
    CHECK(space.cursors == 0);
    CHECK(time(Calls::cursor).checksum == checksum(lengths));
    CHECK(space.cursors == 2);
    CHECK(space.singles == 400);  // a plain cursor calls the structure
    const Counting wrong(1.01);
    const ControlSpace* const of_wrong[] = {&wrong};
    CHECK_THROWS_AS(access_times(of_wrong, points, 1, {Answers::lengths}, 0), std::logic_error);
    CHECK(access_times(of_wrong, points, 1, {}, 0).size() == 1);
}

TEST_CASE("A repeat goes on until it has lasted long enough") {
    int calls = 0;
    const FunctionSpace space([&](const Point&) {
        ++calls;
        return Metric::isotropic(1);
    });
    const AccessTime time = access_time(space, random_points(box, 10, 1), 2, 1e-3);
    // A sample of s ns a point takes 10^6 / s timed points to last 1 ms; 10 more were not timed.
    const double least = 1e6 / time.samples_ns[0] + 1e6 / time.samples_ns[1];
    CHECK(calls - 10 >= least * (1 - 1e-12));
    CHECK(access_time(space, random_points(box, 10, 1), 1, 0).samples_ns.size() == 1);
}

TEST_CASE("A structure that takes too long gets fewer samples, and others all") {
    const FunctionSpace fast([](const Point&) { return Metric::isotropic(1); });
    const FunctionSpace slow([](const Point&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return Metric::isotropic(1);
    });
    const ControlSpace* const spaces[] = {&slow, &fast};
    const auto times = access_times(spaces, random_points(box, 1, 1), 5, {}, 0, 0.01);
    CHECK(times[0].samples_ns.size() == 1);
    CHECK(times[1].samples_ns.size() == 5);
}

TEST_CASE("Answers that change are not timed") {
    // The untimed run is good; answer 35 is of the third timed run of ten points.
    int calls = 0;
    const FunctionSpace fickle(
        [&](const Point&) { return Metric::isotropic(++calls == 35 ? 2 : 1); });
    CHECK_THROWS_AS(access_time(fickle, random_points(box, 10, 1), 100, 0), std::logic_error);
}

TEST_CASE("Timing nothing is refused") {
    const FunctionSpace space([](const Point&) { return Metric::isotropic(1); });
    CHECK_THROWS_AS(access_time(space, {}, 3), InputError);
    CHECK_THROWS_AS(access_time(space, random_points(box, 10, 1), 0), InputError);
    CHECK_THROWS_AS(AccessTime{}.median_ns(), InputError);
}

TEST_CASE("Median and quartiles of samples in any order") {
    const std::vector<double> odd{5, 1, 4, 2, 3}, even{4, 1, 3, 2};
    CHECK(AccessTime{odd, 0}.median_ns() == 3);
    CHECK(quartile(odd, 1) == 2);
    CHECK(quartile(odd, 2) == 3);
    CHECK(quartile(odd, 3) == 4);
    CHECK(quartile(even, 2) == 2.5);
    CHECK(quartile(even, 1) == 1.75);
    CHECK(quartile(even, 3) == 3.25);
    CHECK(quartile({7}, 3) == 7);
    CHECK_THROWS_AS(quartile(odd, 4), InputError);
}

}  // namespace controlspace::access_time_test

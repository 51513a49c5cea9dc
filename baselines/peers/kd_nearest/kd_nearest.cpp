// SPDX-License-Identifier: Apache-2.0
// The sources in nanoflann's kd-tree: what is written in an hour with SciPy's or nanoflann's
// search.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nanoflann.hpp>
#include <span>
#include <vector>

#include "baselines/peers/peer_builder.h"
#include "controlspace/sources/cone.h"

namespace controlspace {

namespace {

/// Sources as nanoflann reads a set of points.
struct Cones {
    std::vector<Point> places;
    std::vector<double> h, slope;
    double least_h = std::numeric_limits<double>::max();
    double least_slope = std::numeric_limits<double>::max();

    explicit Cones(const PeerInput& input) {
        for (const PointSource& source : input.sources) {
            places.push_back(source.position);
            h.push_back(source.metric.xx);
            slope.push_back(cone_growth(source, input.options.ratio) - 1);
            least_h = std::min(least_h, h.back());
            least_slope = std::min(least_slope, slope.back());
        }
    }
    // NOLINTBEGIN(readability-identifier-naming): nanoflann's names
    std::size_t kdtree_get_point_count() const { return places.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return places[i][static_cast<Axis>(axis)];
    }
    bool kdtree_get_bbox(auto&) const { return false; }
    // NOLINTEND(readability-identifier-naming)
};

/// The smallest of all cones, for nanoflann's search: it ends where no cone can be smaller.
class SmallestCone {
public:
    using DistanceType = double;
    SmallestCone(const Cones& cones, double longest) : cones_(cones), smallest_(longest) {
        narrow();
    }
    bool addPoint(double square, std::uint32_t i) {  // NOLINT(readability-identifier-naming)
        const double length = cones_.h[i] + cones_.slope[i] * std::sqrt(square);
        if (length < smallest_) {
            smallest_ = length;
            narrow();
        }
        return true;
    }
    double worstDist() const { return reach_; }  // NOLINT(readability-identifier-naming)
    bool full() const { return true; }
    double length() const { return smallest_; }

private:
    void narrow() {
        const double rise = smallest_ - cones_.least_h;
        const double reach = rise > 0 ? rise / cones_.least_slope : 0;
        reach_ = reach * reach;
    }

    const Cones& cones_;
    double smallest_;
    double reach_ = 0;  // squared
};

constexpr int all = 0;

template <int k>
class KdNearest final : public LengthSpace {
public:
    explicit KdNearest(const PeerInput& input)
        : LengthSpace(input.options.domain), longest_(input.longest()), cones_(input) {}

    Footprint footprint() const override {
        Footprint footprint;
        footprint.control_nodes = cones_.places.size();
        footprint.bytes_payload =
            cones_.h.capacity() * 2 * sizeof(double) + cones_.places.capacity() * sizeof(Point);
        footprint.bytes_topology = index_.usedMemory(index_);
        return footprint;
    }

protected:
    void lengths(std::span<const Point> x, std::span<double> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = length_at(x[i]);
    }

private:
    double length_at(const Point& x) const {
        if constexpr (k == all) {
            SmallestCone found(cones_, longest_);
            index_.findNeighbors(found, x.data(), nanoflann::SearchParams());
            return found.length();
        } else {
            std::array<std::uint32_t, k> nearest;
            std::array<double, k> squares;
            const auto count = index_.knnSearch(x.data(), k, nearest.data(), squares.data());
            double length = longest_;
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint32_t source = nearest[i];
                length = std::min(length,
                                  cones_.h[source] + cones_.slope[source] * std::sqrt(squares[i]));
            }
            return length;
        }
    }

    double longest_;
    Cones cones_;
    // usedMemory reads only, but takes a reference that is not const.
    mutable nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cones>, Cones,
                                                3, std::uint32_t>
        index_{3, cones_};
};

template <int k>
std::unique_ptr<ControlSpace> make(const PeerInput& input) {
    return std::make_unique<KdNearest<k>>(input);
}
template <int k>
CatalogueEntry row(std::string id, const std::string& which) {
    return peer_row<make<k>, PeerValue::length>(
        std::move(id), "nanoflann's kd-tree of the sources, the smallest cone of " + which, 1);
}

}  // namespace

std::vector<CatalogueEntry> kd_nearest_rows() {
    return {row<8>("kd-nearest", "the 8 nearest"), row<1>("kd-nearest-1", "only the nearest"),
            row<64>("kd-nearest-64", "the 64 nearest"), row<all>("kd-nearest-all", "all: exact")};
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
// Netgen's LocalH: an octree of lengths, refined where sizes are restricted, one source after the
// other, as Mesh::RestrictLocalH does. Its law is its own: a restriction counts only where it is
// below 1/1.2 of what is held (a dead band of 20 %), and grows from box to box along the axes.
#include <mystdlib.h>  // Netgen's, which its other headers need first

#include <algorithm>
#include <cstdlib>
#include <gprim.hpp>
#include <memory>
#include <meshing/localh.hpp>
#include <myadt.hpp>
#include <span>
#include <vector>

#include "baselines/peers/peer_builder.h"
#include "cones/cone_field.h"
#include "controlspace/sources/cone.h"

namespace controlspace {

namespace {

netgen::Point<3> netgen_point(const Point& p) { return {p.x(), p.y(), p.z()}; }

// LocalH shows neither its boxes nor their lengths. C++ lets explicit instantiations name private
// members, and their friends return them.
using Boxes = netgen::Array<netgen::GradingBox*> netgen::LocalH::*;
using Length = double netgen::GradingBox::*;
Boxes boxes_of(netgen::LocalH*);
Length length_of(netgen::GradingBox*);
template <Boxes member>
struct ShowBoxes {
    friend Boxes boxes_of(netgen::LocalH*) { return member; }
};
template <Length member>
struct ShowLength {
    friend Length length_of(netgen::GradingBox*) { return member; }
};
template struct ShowBoxes<&netgen::LocalH::boxes>;
template struct ShowLength<&netgen::GradingBox::hopt>;

// A corner of LocalH's box. It ignores places outside, and those of a plane across x or y would be
// so by rounding: such a box is as thick as long.
netgen::Point<3> corner(const Box& domain, double side) {
    const Vector edges = domain.edges();
    Point p = side < 0 ? domain.low : domain.high;
    for (Axis a = 0; a < 2; ++a) {
        if (edges[a] == 0) p[a] += side * edges.maxCoeff();
    }
    return netgen_point(p);
}

enum class Law { own, exact };

/// The box of LocalH is a little larger than the domain, in some versions by a random amount: with
/// std::srand the structure is the same each time. Of a plane across z it is a quadtree.
template <Law law>
class NetgenSizes final : public LengthSpace {
public:
    explicit NetgenSizes(const PeerInput& input)
        : LengthSpace(input.options.domain),
          longest_(input.longest()),
          sizes_((std::srand(1), corner(domain(), -0.5)), corner(domain(), 0.5), 0,
                 domain().edges().z() == 0 ? 2 : 3) {
        for (const PointSource& source : input.sources) {
            sizes_.SetGrading(cone_growth(source, input.options.ratio) - 1);
            sizes_.SetH(netgen_point(source.position), source.metric.xx);
        }
        if (law == Law::exact) set_exact(input);
    }

    Footprint footprint() const override {
        const auto boxes = static_cast<std::size_t>(all_boxes().Size());
        Footprint footprint;
        footprint.tree_nodes = footprint.cells = footprint.control_nodes = boxes;
        footprint.bytes_payload = boxes * sizeof(double);
        footprint.bytes_topology = boxes * (sizeof(netgen::GradingBox) - sizeof(double));
        footprint.bytes_auxiliary = boxes * sizeof(netgen::GradingBox*);
        return footprint;
    }

protected:
    void lengths(std::span<const Point> x, std::span<double> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = std::min(longest_, sizes_.GetH(netgen_point(x[i])));
        }
    }

private:
    const netgen::Array<netgen::GradingBox*>& all_boxes() const {
        return sizes_.*boxes_of(nullptr);
    }

    // Every box gets the exact field at its centre.
    void set_exact(const PeerInput& input) {
        const ConeField field(input.sources, input.options.ratio, largest_metric(input.options));
        std::vector<Point> centres;
        for (netgen::GradingBox* box : all_boxes()) {
            const netgen::Point<3> c = box->PMid();
            centres.push_back(nearest_in(domain(), Point(c(0), c(1), c(2))));
        }
        std::vector<Metric> exact(centres.size());
        field.evaluate(centres, exact);
        for (std::size_t i = 0; i < exact.size(); ++i) {
            all_boxes()[static_cast<int>(i)]->*length_of(nullptr) = exact[i].xx;
        }
    }

    double longest_;
    netgen::LocalH sizes_;
};

template <Law law>
std::unique_ptr<ControlSpace> make(const PeerInput& input) {
    return std::make_unique<NetgenSizes<law>>(input);
}

}  // namespace

std::vector<CatalogueEntry> netgen_rows() {
    return {
        peer_row<make<Law::own>, PeerValue::length>(
            "netgen-localh", "Netgen's LocalH: an octree of lengths, by its own law of growth", 0),
        peer_row<make<Law::exact>, PeerValue::length>(
            "netgen-localh-exact", "the same octree, the exact field at its boxes' centres", 0)};
}

}  // namespace controlspace

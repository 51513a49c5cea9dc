// SPDX-License-Identifier: Apache-2.0
// The leaves of K_oL as a forest of p4est, and p4est's binary search of them.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <p8est_search.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "baselines/peers/converted_builder.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"
#include "refuse.h"

namespace controlspace {

namespace {

/// One tree: the domain is a corner of its root, whose cubes are cut until they are as K_oL's
/// boxes, which cuts the domain's long axes alone at first. In a flat domain the lowest layer alone
/// is cut, of two.
class Forest final : public ControlSpace {
public:
    static constexpr double usual_rounding = 1;
    static constexpr double rounding() { return 1; }

    explicit Forest(const ControlSpace& octree) : octree_(&octree), domain_(octree.domain()) {
        footprint_.depth = octree.footprint().depth;
        if (footprint_.depth > P8EST_QMAXLEVEL) {
            refuse("p4est holds 18 levels: lower --max-depth, or leave p4est-octree out");
        }
        Vector cubes = Vector::Ones();  // along each axis
        for (; long_levels_ < footprint_.depth; ++long_levels_) {
            const auto cuts = long_axes(domain_, long_levels_);
            if (cuts == octants(domain_).cuts) break;
            for (Axis a = 0; a < 3; ++a) cubes[a] *= cuts[static_cast<std::size_t>(a)] ? 2 : 1;
        }
        const Vector ends = cubes * P8EST_QUADRANT_LEN(long_levels_);
        scale_ = ends.cwiseQuotient(divisible_edges(domain_));
        ends_ = (domain_.edges().array() > 0).select(ends, 1);
        forest_ = {p8est_new_ext(sc_MPI_COMM_SELF, connectivity_.get(), 0, 0, 1, 0, nullptr, this),
                   p8est_destroy};
        p8est_refine(forest_.get(), 1, is_cut, nullptr);
        leaves_ = &p8est_tree_array_index(forest_->trees, 0)->quadrants;
        std::vector<Point> centres;
        for (std::size_t i = 0; i < leaves_->elem_count; ++i) {
            const p8est_quadrant_t& q = *p8est_quadrant_array_index(leaves_, i);
            centres.push_back(centre(q));
            footprint_.cells += is_inside(q) ? 1 : 0;
        }
        metrics_.resize(centres.size());
        octree.sample(centres, metrics_);
        octree_ = nullptr;
        footprint_.tree_nodes = footprint_.control_nodes = footprint_.cells;
        footprint_.bytes_payload = metrics_.capacity() * sizeof(Metric);
        footprint_.bytes_topology = p8est_memory_used(forest_.get());
    }

    // The first one of a process starts MPI, which takes some tenths of a second and is not part of
    // creation.
    static std::unique_ptr<ControlSpaceBuilder> ours(const SpaceOptions& options) {
        [[maybe_unused]] static const bool once = [] {
            int started = 0;
            MPI_Initialized(&started);
            if (!started) {
                MPI_Init(nullptr, nullptr);
                std::atexit([] { MPI_Finalize(); });
            }
            sc_init(sc_MPI_COMM_SELF, 0, 0, nullptr, SC_LP_SILENT);
            p4est_init(nullptr, SC_LP_SILENT);
            return true;
        }();
        return find_entry(tree_catalogue(), "K_oL")->make(options);
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        p8est_quadrant_t place{};
        place.level = P8EST_MAXLEVEL;
        const auto at = [this](double t, Axis a) {  // a face belongs to the low side
            return static_cast<p4est_qcoord_t>(std::clamp(std::ceil(t) - 1, 0.0, ends_[a] - 1));
        };
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Vector t = (x[i] - domain_.low).cwiseProduct(scale_);
            place.x = at(t.x(), 0);
            place.y = at(t.y(), 1);
            place.z = at(t.z(), 2);
            out[i] =
                metrics_[static_cast<std::size_t>(p8est_find_higher_bound(leaves_, &place, 0))];
        }
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override { return footprint_; }

private:
    bool is_inside(const p8est_quadrant_t& q) const {
        return q.x < ends_.x() && q.y < ends_.y() && q.z < ends_.z();
    }
    Point centre(const p8est_quadrant_t& q) const {
        const double half = 0.5 * P8EST_QUADRANT_LEN(q.level);
        const Vector t(q.x + half, q.y + half, q.z + half);
        return (domain_.low + t.cwiseQuotient(scale_)).cwiseMin(domain_.high);
    }
    // Where the octree's leaf at the centre is smaller than the quadrant.
    static int is_cut(p8est_t* forest, p4est_topidx_t, p8est_quadrant_t* q) {
        const Forest& self = *static_cast<const Forest*>(forest->user_pointer);
        if (!self.is_inside(*q)) return 0;
        if (q->level < self.long_levels_) return 1;
        const Vector leaf = self.octree_->cell_at(self.centre(*q))->edges();
        const Vector own = P8EST_QUADRANT_LEN(q->level) * self.scale_.cwiseInverse();
        return (leaf.array() > 0 && leaf.array() < 0.75 * own.array()).any();
    }

    const ControlSpace* octree_;  // while it is made
    Box domain_;
    Footprint footprint_;
    int long_levels_ = 0;
    Vector scale_, ends_;  // of the domain, in p4est's integers
    std::shared_ptr<p8est_connectivity_t> connectivity_{p8est_connectivity_new_unitcube(),
                                                        p8est_connectivity_destroy};
    std::shared_ptr<p8est_t> forest_;
    sc_array_t* leaves_ = nullptr;
    std::vector<Metric> metrics_;
};

}  // namespace

std::vector<CatalogueEntry> p4est_rows() {
    return {converted_row<Forest>(
        "p4est-octree",
        "the leaves of K_oL as a forest of p4est, found by p8est_find_higher_bound")};
}

}  // namespace controlspace

// The leaves of K_oL as a forest of p4est, one octree over the domain, and p4est's binary search of
// them.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <p8est_search.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "baselines/peers/converted_builder.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"

namespace controlspace {

namespace {

// The first builder of a process starts MPI, which takes some tenths of a second and is not part of
// creation.
void start_mpi() {
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
}

/// A brick of trees, as many along each axis as K_oL cuts it more often than the others, so that
/// quadrants are its boxes. In a flat domain their lowest layer alone is cut.
class Forest final : public ControlSpace {
public:
    explicit Forest(const ControlSpace& octree)
        : octree_(&octree), domain_(octree.domain()), depth_(octree.footprint().depth) {
        if (depth_ > P8EST_QMAXLEVEL) {
            throw InputError(
                "p4est holds 18 levels: lower --max-depth, or leave p4est-octree out of "
                "--structures");
        }
        for (int level = 0; level < depth_; ++level) {
            const auto cuts = long_axes(domain_, level);
            if (cuts == octants(domain_).cuts) break;
            for (std::size_t a = 0; a < 3; ++a) brick_[a] <<= cuts[a];
        }
        constexpr std::int64_t most_trees = 1 << 16;
        if (brick_[0] * brick_[1] * brick_[2] > most_trees) {
            throw InputError(
                "the domain is too oblong for p4est, more than 65536 cubes: leave p4est-octree "
                "out of --structures");
        }
        const auto along = [&](std::size_t a) { return static_cast<int>(brick_[a]); };
        connectivity_.reset(p8est_connectivity_new_brick(along(0), along(1), along(2), 0, 0, 0));
        forest_.reset(
            p8est_new_ext(sc_MPI_COMM_SELF, connectivity_.get(), 0, 0, 1, 0, nullptr, this));
        p8est_refine(forest_.get(), 1, is_cut, nullptr);
        std::vector<Point> centres;
        trees_.resize(static_cast<std::size_t>(connectivity_->num_trees));
        for (p4est_topidx_t t = 0; t < connectivity_->num_trees; ++t) {
            trees_[index(place_in_brick(t))] = t;
            sc_array_t* leaves = &p8est_tree_array_index(forest_->trees, t)->quadrants;
            for (std::size_t i = 0; i < leaves->elem_count; ++i) {
                centres.push_back(centre(t, *p8est_quadrant_array_index(leaves, i)));
            }
        }
        metrics_.resize(centres.size());
        octree.sample(centres, metrics_);
        octree_ = nullptr;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const Vector most_places = trees_along() * P8EST_ROOT_LEN;
        const Vector scale = most_places.cwiseQuotient(divisible_edges(domain_));
        p8est_quadrant_t place{};
        place.level = P8EST_MAXLEVEL;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Vector t = (x[i] - domain_.low).cwiseProduct(scale);
            std::array<p4est_topidx_t, 3> at;
            std::array<p4est_qcoord_t, 3> within;
            for (std::size_t a = 0; a < 3; ++a) {
                // A face belongs to the low side.
                const auto axis = static_cast<Axis>(a);
                const auto along = static_cast<std::int64_t>(
                    std::clamp(std::ceil(t[axis]) - 1, 0.0, most_places[axis] - 1));
                at[a] = static_cast<p4est_topidx_t>(along >> P8EST_MAXLEVEL);
                within[a] = static_cast<p4est_qcoord_t>(along & (P8EST_ROOT_LEN - 1));
            }
            place.x = within[0];
            place.y = within[1];
            place.z = within[2];
            p8est_tree_t* tree = p8est_tree_array_index(forest_->trees, trees_[index(at)]);
            const auto leaf =
                static_cast<std::size_t>(p8est_find_higher_bound(&tree->quadrants, &place, 0));
            out[i] = metrics_[static_cast<std::size_t>(tree->quadrants_offset) + leaf];
        }
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint footprint;
        footprint.tree_nodes = footprint.cells = footprint.control_nodes = metrics_.size();
        footprint.depth = depth_;
        footprint.bytes_payload = metrics_.capacity() * sizeof(Metric);
        footprint.bytes_topology = p8est_memory_used(forest_.get());
        if (flat_axis(domain_)) {
            footprint.remark = "3D forest in a plane: two layers where the octree has one";
        }
        return footprint;
    }

private:
    Vector trees_along() const {
        return Eigen::Map<const Eigen::Vector<std::int64_t, 3>>(brick_.data()).cast<double>();
    }
    std::size_t index(const std::array<p4est_topidx_t, 3>& at) const {
        return static_cast<std::size_t>(at[0] + brick_[0] * (at[1] + brick_[1] * at[2]));
    }
    std::array<p4est_topidx_t, 3> place_in_brick(p4est_topidx_t tree) const {
        const double* low = connectivity_->vertices + 3 * connectivity_->tree_to_vertex[8 * tree];
        return {static_cast<int>(low[0]), static_cast<int>(low[1]), static_cast<int>(low[2])};
    }
    Point centre(p4est_topidx_t tree, const p8est_quadrant_t& q) const {
        const auto at = place_in_brick(tree);
        const double half = 0.5 * P8EST_QUADRANT_LEN(q.level);
        const Vector t = Vector(at[0], at[1], at[2]) +
                         Vector(q.x + half, q.y + half, q.z + half) / P8EST_ROOT_LEN;
        return domain_.low + t.cwiseProduct(domain_.edges()).cwiseQuotient(trees_along());
    }
    // Where the octree's leaf at the centre is smaller than the quadrant.
    static int is_cut(p8est_t* forest, p4est_topidx_t tree, p8est_quadrant_t* q) {
        const Forest& self = *static_cast<const Forest*>(forest->user_pointer);
        const Vector edges = self.domain_.edges();
        const Vector low(q->x, q->y, q->z);
        if ((edges.array() == 0 && low.array() > 0).any()) return 0;
        const Vector leaf = self.octree_->cell_at(self.centre(tree, *q))->edges();
        const Vector own = edges.cwiseQuotient(self.trees_along()) / (1 << q->level);
        return leaf.maxCoeff() < 0.75 * own.maxCoeff();
    }

    template <auto destroy>
    struct Destroy {
        void operator()(auto* p) const { destroy(p); }
    };
    const ControlSpace* octree_;  // while it is made
    Box domain_;
    int depth_;
    std::array<std::int64_t, 3> brick_{1, 1, 1};
    std::unique_ptr<p8est_connectivity_t, Destroy<p8est_connectivity_destroy>> connectivity_;
    std::unique_ptr<p8est_t, Destroy<p8est_destroy>> forest_;
    std::vector<p4est_topidx_t> trees_;
    std::vector<Metric> metrics_;
};

std::unique_ptr<ControlSpace> converted(const ControlSpace& octree) {
    return std::make_unique<Forest>(octree);
}

}  // namespace

std::vector<CatalogueEntry> p4est_rows() {
    return {
        {.id = "p4est-octree",
         .description = "the leaves of K_oL as a forest of p4est, found by p8est_find_higher_bound",
         .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
             start_mpi();
             return std::make_unique<ConvertedBuilder>(
                 find_entry(tree_catalogue(), "K_oL")->make(options), converted);
         },
         .capabilities = {SourceLeaves()}}};
}

}  // namespace controlspace

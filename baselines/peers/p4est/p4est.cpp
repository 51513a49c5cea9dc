// The leaves of K_oL as a forest of p4est, one octree over the domain, and its search.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <p8est_search.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "baselines/peers/converted_builder.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"

namespace controlspace {

namespace {

// The first forest of a process starts MPI, which takes some tenths of a second.
void start_mpi() {
    int started = 0;
    MPI_Initialized(&started);
    if (started) return;
    MPI_Init(nullptr, nullptr);
    std::atexit([] { MPI_Finalize(); });
    sc_init(sc_MPI_COMM_SELF, 0, 0, nullptr, SC_LP_SILENT);
    p4est_init(nullptr, SC_LP_SILENT);
}

struct Search {
    p4est_topidx_t tree;
    std::array<p4est_qcoord_t, 3> place;
    p4est_locidx_t leaf;
};

/// A brick of trees, as many along each axis as K_oL cuts it more often than the others, so that
/// quadrants are its boxes. In a flat domain their lowest layer alone is cut.
class Forest final : public ControlSpace {
public:
    explicit Forest(const ControlSpace& octree)
        : octree_(&octree), domain_(octree.domain()), depth_(octree.footprint().depth) {
        if (depth_ > P8EST_QMAXLEVEL) {
            throw InputError("p4est holds 18 levels: lower --max-depth, or leave it out");
        }
        for (int level = 0; level < depth_; ++level) {
            const auto cuts = long_axes(domain_, level);
            if (cuts == octants(domain_).cuts) break;
            for (std::size_t a = 0; a < 3; ++a) brick_[a] <<= cuts[a];
        }
        start_mpi();
        connectivity_.reset(p8est_connectivity_new_brick(brick_[0], brick_[1], brick_[2], 0, 0, 0));
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

    // libsc counts its allocations without a lock: after several threads the counts alone are
    // wrong.
    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        constexpr std::size_t most = 4096;
        std::array<Search, most> found;
        const Vector most_places = trees_along() * P8EST_ROOT_LEN;
        const Vector scale = most_places.cwiseQuotient(divisible_edges(domain_));
        for (std::size_t first = 0; first < x.size(); first += most) {
            const std::size_t count = std::min(most, x.size() - first);
            for (std::size_t i = 0; i < count; ++i) {
                const Vector t = (x[first + i] - domain_.low).cwiseProduct(scale);
                std::array<p4est_topidx_t, 3> tree;
                for (std::size_t a = 0; a < 3; ++a) {
                    // A face belongs to the low side.
                    const auto axis = static_cast<Axis>(a);
                    const auto place = static_cast<p4est_qcoord_t>(
                        std::clamp(std::ceil(t[axis]) - 1, 0.0, most_places[axis] - 1));
                    tree[a] = place >> P8EST_MAXLEVEL;
                    found[i].place[a] = place & (P8EST_ROOT_LEN - 1);
                }
                found[i].tree = trees_[index(tree)];
            }
            sc_array_t points;
            sc_array_init_data(&points, found.data(), sizeof(Search), count);
            p8est_search_local(forest_.get(), 0, nullptr, is_inside, &points);
            for (std::size_t i = 0; i < count; ++i) {
                out[first + i] = metrics_[static_cast<std::size_t>(found[i].leaf)];
            }
        }
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint footprint;
        footprint.tree_nodes = footprint.cells = footprint.control_nodes = metrics_.size();
        footprint.depth = depth_;
        footprint.bytes_payload = metrics_.capacity() * sizeof(Metric);
        footprint.bytes_topology = p8est_memory_used(forest_.get());
        return footprint;
    }

private:
    Vector trees_along() const { return Vector(brick_[0], brick_[1], brick_[2]); }
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
    static int is_inside(p8est_t*, p4est_topidx_t tree, p8est_quadrant_t* q, p4est_locidx_t leaf,
                         void* point) {
        auto& search = *static_cast<Search*>(point);
        const p4est_qcoord_t outside =
            (search.place[0] ^ q->x) | (search.place[1] ^ q->y) | (search.place[2] ^ q->z);
        if (search.tree != tree || outside >= P8EST_QUADRANT_LEN(q->level)) return 0;
        if (leaf >= 0) search.leaf = leaf;
        return 1;
    }

    template <auto destroy>
    struct Destroy {
        void operator()(auto* p) const { destroy(p); }
    };
    const ControlSpace* octree_;  // while it is made
    Box domain_;
    int depth_;
    std::array<int, 3> brick_{1, 1, 1};
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
    return {{.id = "p4est-octree",
             .description = "the leaves of K_oL as a forest of p4est, found by p8est_search_local",
             .family = "peers",
             .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                 return std::make_unique<ConvertedBuilder>(
                     find_entry(tree_catalogue(), "K_oL")->make(options), converted);
             },
             .capabilities = {SourceLeaves()}}};
}

}  // namespace controlspace

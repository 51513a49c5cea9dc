// The leaves of K_oL as a forest of p4est, one octree over the domain, and its search.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <p8est.h>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <p8est_search.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "baselines/peers/peer_builder.h"
#include "controlspace/geometry/extent.h"

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
    std::array<p4est_qcoord_t, 3> place;
    p4est_locidx_t leaf;
};

class Forest final : public ControlSpace {
public:
    explicit Forest(const ControlSpace& octree) : domain_(octree.domain()) {
        start_mpi();
        const Refinement refinement{octree, domain_};
        connectivity_.reset(p8est_connectivity_new_unitcube());
        forest_.reset(p8est_new_ext(sc_MPI_COMM_SELF, connectivity_.get(), 0, 0, 1, 0, nullptr,
                                    const_cast<Refinement*>(&refinement)));
        p8est_refine(forest_.get(), 1, is_cut, nullptr);
        forest_->user_pointer = nullptr;
        std::vector<Point> centres;
        p8est_tree_t* tree = p8est_tree_array_index(forest_->trees, 0);
        for (std::size_t i = 0; i < tree->quadrants.elem_count; ++i) {
            centres.push_back(refinement.centre(*p8est_quadrant_array_index(&tree->quadrants, i)));
        }
        metrics_.resize(centres.size());
        octree.sample(centres, metrics_);
        depth_ = tree->maxlevel;
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        constexpr std::size_t most = 4096;
        std::array<Search, most> found;
        const Vector scale =
            Vector::Constant(P8EST_ROOT_LEN).cwiseQuotient(divisible_edges(domain_));
        constexpr double last = P8EST_ROOT_LEN - 1;
        for (std::size_t first = 0; first < x.size(); first += most) {
            const std::size_t count = std::min(most, x.size() - first);
            for (std::size_t i = 0; i < count; ++i) {
                const Vector t = (x[first + i] - domain_.low).cwiseProduct(scale);
                for (Axis a = 0; a < 3; ++a) {
                    found[i].place[static_cast<std::size_t>(a)] =
                        static_cast<p4est_qcoord_t>(std::clamp(t[a], 0.0, last));
                }
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
    struct Refinement {
        const ControlSpace& octree;
        const Box& domain;
        Point centre(const p8est_quadrant_t& q) const {
            const double half = 0.5 * P8EST_QUADRANT_LEN(q.level);
            const Vector t = Vector(q.x + half, q.y + half, q.z + half) / P8EST_ROOT_LEN;
            return domain.low + t.cwiseProduct(domain.edges());
        }
    };
    // Where the octree's leaf at the centre is smaller than the quadrant.
    static int is_cut(p8est_t* forest, p4est_topidx_t, p8est_quadrant_t* q) {
        const auto& refinement = *static_cast<const Refinement*>(forest->user_pointer);
        const Vector leaf = refinement.octree.cell_at(refinement.centre(*q))->edges();
        const Vector edges = refinement.domain.edges() / (1 << q->level);
        return leaf.maxCoeff() < 0.75 * edges.maxCoeff();
    }
    static int is_inside(p8est_t*, p4est_topidx_t, p8est_quadrant_t* q, p4est_locidx_t leaf,
                         void* point) {
        auto& search = *static_cast<Search*>(point);
        const p4est_qcoord_t outside =
            (search.place[0] ^ q->x) | (search.place[1] ^ q->y) | (search.place[2] ^ q->z);
        if (outside >= P8EST_QUADRANT_LEN(q->level)) return 0;
        if (leaf >= 0) search.leaf = leaf;
        return 1;
    }

    template <auto destroy>
    struct Destroy {
        void operator()(auto* p) const { destroy(p); }
    };
    Box domain_;
    std::unique_ptr<p8est_connectivity_t, Destroy<p8est_connectivity_destroy>> connectivity_;
    std::unique_ptr<p8est_t, Destroy<p8est_destroy>> forest_;
    std::vector<Metric> metrics_;
    int depth_ = 0;
};

/// K_oL's builder; what it builds is moved to a forest.
class ForestBuilder final : public ControlSpaceBuilder {
public:
    explicit ForestBuilder(const SpaceOptions& options)
        : octree_(find_entry(tree_catalogue(), "K_oL")->make(options)) {}

    InsertionReport insert(std::span<const PointSource> sources) override {
        return octree_->insert(sources);
    }
    GradationReport grade(const GradationOptions& options) override {
        return octree_->grade(options);
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override { return octree_->adapt(goal); }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) throw InputError("a forest of p4est has no compact form");
        return std::make_unique<Forest>(*octree_->build());
    }
    Box domain() const override { return octree_->domain(); }

private:
    std::unique_ptr<ControlSpaceBuilder> octree_;
};

}  // namespace

std::vector<CatalogueEntry> p4est_rows() {
    return {{.id = "p4est-octree",
             .description = "the leaves of K_oL as a forest of p4est, found by p8est_search_local",
             .family = "peers",
             .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                 return std::make_unique<ForestBuilder>(options);
             },
             .capabilities = {SourceLeaves()}}};
}

}  // namespace controlspace

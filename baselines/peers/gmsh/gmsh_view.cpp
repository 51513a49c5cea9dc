#include <gmsh.h>

#include <algorithm>
#include <utility>

#include "baselines/peers/gmsh/gmsh_field.h"
#include "baselines/peers/gmsh/gmsh_rows.h"
#include "baselines/peers/tets/background_tets.h"
#include "controlspace/sources/riemannian.h"
#include "controlspace/space/detail/shared_builder.h"

namespace controlspace {

namespace {

/// The tetrahedra of `tets-linear` as a view of Gmsh behind its field PostView: of isotropic
/// metrics sizes, otherwise the Riemannian tensors that meshers expect; linear in these.
class GmshView final : public ControlSpace, public Saved {
public:
    explicit GmshView(const BackgroundTets& tets)
        : domain_(tets.domain()),
          counts_(tets.footprint()),
          has_tensors_(!is_isotropic(tets)),
          field_([&](auto& made) { make(made, tets, has_tensors_); }, domain_.centre(),
                 has_tensors_) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const std::vector<Point> inside = inside_of(x);
        if (!has_tensors_) {
            std::vector<double> sizes(x.size());
            field_.sizes(inside, sizes);
            std::ranges::transform(sizes, out.begin(), Metric::isotropic);
            return;
        }
        std::vector<GmshField::Tensor> tensors(x.size());
        field_.tensors(inside, tensors);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto& t = tensors[i];
            const auto metric = from_riemannian({t[0], t[2], t[5], t[1], t[3], t[4]});
            if (!metric)
                throw InputError(
                    "Gmsh's view has no metric at a place: leave it out of --structures");
            out[i] = *metric;
        }
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if (has_tensors_) return ControlSpace::sample_lengths(x, out);
        field_.sizes(inside_of(x), out);
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint footprint;
        footprint.cells = counts_.cells;
        footprint.control_nodes = counts_.control_nodes;
        // Each tetrahedron holds its own copy of its vertices.
        const std::size_t corners = domain_.edges().minCoeff() > 0 ? 4 : 3;
        footprint.bytes_payload = counts_.cells * corners * (has_tensors_ ? 9 : 1) * sizeof(double);
        footprint.bytes_topology =
            std::max(field_.bytes(), footprint.bytes_payload) - footprint.bytes_payload;
        return footprint;
    }
    void save(StateWriter&) const override {
        throw InputError("a view of Gmsh is not saved: save tets-linear, or export a .pos file");
    }

private:
    static bool is_isotropic(const BackgroundTets& tets) {
        return std::ranges::all_of(tets.mesh().finite_vertex_handles(), [&](auto vertex) {
            return controlspace::is_isotropic(tets.metric(vertex));
        });
    }
    static void make(GmshField::Made& made, const BackgroundTets& tets, bool has_tensors) {
        const int corners = tets.corners_of_cell();
        std::vector<double> data;
        int cells = 0;
        tets.for_each_cell([&](Delaunay::Cell_handle cell) {
            ++cells;
            for (int axis = 0; axis < 3; ++axis) {
                for (int i = 0; i < corners; ++i) {
                    data.push_back(BackgroundTets::position(cell->vertex(i))[axis]);
                }
            }
            for (int i = 0; i < corners; ++i) {
                const Metric m = tets.metric(cell->vertex(i));
                if (has_tensors) {
                    const Metric r = to_riemannian(m);
                    data.insert(data.end(), {r.xx, r.xy, r.xz, r.xy, r.yy, r.yz, r.xz, r.yz, r.zz});
                } else {
                    data.push_back(m.xx);
                }
            }
        });
        const int view = made.view = gmsh::view::add("sizes");
        gmsh::view::addListData(
            view, std::string(has_tensors ? "T" : "S") + (corners == 4 ? "S" : "T"), cells, data);
        const int field = made.field = gmsh::model::mesh::field::add("PostView");
        gmsh::model::mesh::field::setNumber(field, "ViewTag", view);
    }
    std::vector<Point> inside_of(std::span<const Point> x) const {
        std::vector<Point> inside(x.begin(), x.end());
        for (Point& p : inside) p = p.cwiseMax(domain_.low).cwiseMin(domain_.high);
        return inside;
    }

    Box domain_;
    Footprint counts_;
    bool has_tensors_;
    GmshField field_;
};

struct ViewedTets : BackgroundTets {
    explicit ViewedTets(const SpaceOptions& options) : BackgroundTets(options, TetBlend::metrics) {}
    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const ViewedTets>& tets) {
        return std::make_unique<GmshView>(*tets);
    }
};

}  // namespace

CatalogueEntry gmsh_view_row() {
    return {.id = "gmsh-view",
            .description =
                "the tetrahedra of tets-linear as a view of Gmsh, asked by its field "
                "PostView: sizes; of tensors M^-2, linear",
            .order = 1,
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                open_gmsh();
                return std::make_unique<SharedBuilder<ViewedTets>>(options);
            },
            .capabilities = {MetricNodes{.rounding = 1e-6}}};
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
// Netgen's, before MPI's; mystdlib.h before the others.
// clang-format off
#include <mystdlib.h>
#include <gprim.hpp>
#include <meshing/localh.hpp>
#include <myadt.hpp>
// clang-format on

#include "bare_loops.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <fmt/format.h>
#include <fmt/ostream.h>
#include <gmsh.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/Grid.h>
#include <openvdb/tools/Interpolation.h>
#include <p8est.h>
#include <p8est_extended.h>
#include <p8est_search.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nanoflann.hpp>
#include <string>
#include <vector>

#include "baselines/peers/gmsh/gmsh_classes.h"

namespace controlspace {

namespace {

struct Places {
    std::span<const PointSource> sources;
    std::size_t kdtree_get_point_count() const { return sources.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return sources[i].position[static_cast<Axis>(axis)];
    }
    bool kdtree_get_bbox(auto&) const { return false; }
};

netgen::Point<3> netgen_point(const Point& p) { return {p.x(), p.y(), p.z()}; }

/// Of a grid whose nodes are the voxels' centres (order 0) or their corners (order 1): the place in
/// units of voxels from the first node, within the domain.
Vector in_voxels(const Point& x) { return (x - bare_domain.low) / bare_voxel; }

/// visit(i, j, k, length) for all nodes.
template <int order>
void for_each_node(const ControlSpace& field, const auto& visit) {
    constexpr int nodes = order == 0 ? bare_voxels : bare_voxels + 1;
    for (int n = 0; n < nodes * nodes * nodes; ++n) {
        const int i = n % nodes, j = n / nodes % nodes, k = n / nodes / nodes;
        const Vector half = Vector::Constant(order == 0 ? 0.5 : 0);
        visit(i, j, k, field.length_at(bare_domain.low + bare_voxel * (Vector(i, j, k) + half)));
    }
}

template <int order>
openvdb::FloatGrid::Ptr float_grid(const ControlSpace& field) {
    auto grid = openvdb::FloatGrid::create();
    auto write = grid->getAccessor();
    for_each_node<order>(field, [&](int i, int j, int k, double h) {
        write.setValue({i, j, k}, static_cast<float>(h));
    });
    return grid;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

using Mesh =
    CGAL::Delaunay_triangulation_3<Kernel,
                                   CGAL::Triangulation_data_structure_3<
                                       CGAL::Triangulation_vertex_base_with_info_3<double, Kernel>,
                                       CGAL::Delaunay_triangulation_cell_base_3<Kernel>>>;

Kernel::Point_3 place(const Point& p) { return {p.x(), p.y(), p.z()}; }

/// Tetrahedra of the sources and corners, their vertices' lengths those of the field.
std::shared_ptr<Mesh> tetrahedra(const ControlSpace& field, std::span<const PointSource> sources) {
    auto mesh = std::make_shared<Mesh>();
    const auto add = [&](const Point& p) {
        mesh->insert(place(p))->info() = sample_at(field, p).xx;
    };
    for (const PointSource& source : sources) add(source.position);
    for (int i = 0; i < 8; ++i) {
        add({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
    }
    return mesh;
}

/// A field of the given kind in a model of its own, evaluated one place after the other.
template <class GmshField>
Loop bare_gmsh(const std::string& kind, const auto& set) {
    gmsh::model::add("bare");
    const int tag = gmsh::model::mesh::field::add(kind);
    set(tag);
    auto* field = reinterpret_cast<GmshField*>(GModel::current()->getFields()->get(tag));
    return [field](std::span<const Point> x, std::span<double> out) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = (*field)(x[i].x(), x[i].y(), x[i].z(), nullptr);
        }
    };
}

Point centre(const p8est_quadrant_t& q) {
    const double half = 0.5 * P8EST_QUADRANT_LEN(q.level);
    return bare_domain.low + Vector(q.x + half, q.y + half, q.z + half) * 2 / P8EST_ROOT_LEN;
}

int is_cut(p8est_t* forest, p4est_topidx_t, p8est_quadrant_t* q) {
    const auto& octree = *static_cast<const ControlSpace*>(forest->user_pointer);
    return octree.cell_at(centre(*q))->edges().x() < 1.5 / (1 << q->level);
}

}  // namespace

Loop bare_nanoflann(std::span<const PointSource> sources) {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Places>,
                                                     Places, 3, std::uint32_t>;
    const auto places = std::make_shared<Places>(Places{sources});
    const auto tree = std::make_shared<Tree>(3, *places);
    return [places, tree, sources](std::span<const Point> x, std::span<double> out) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            std::array<std::uint32_t, 8> nearest;
            std::array<double, 8> squares;
            const std::size_t found =
                tree->knnSearch(x[i].data(), 8, nearest.data(), squares.data());
            double h = bare_domain.half_diagonal();
            for (std::size_t k = 0; k < found; ++k) {
                h = std::min(h, sources[nearest[k]].metric.xx + bare_slope * std::sqrt(squares[k]));
            }
            out[i] = h;
        }
    };
}

Loop bare_netgen(std::span<const PointSource> sources) {
    std::srand(1);  // LocalH moves its box by a random amount
    const auto sizes = std::make_shared<netgen::LocalH>(netgen_point(bare_domain.low),
                                                        netgen_point(bare_domain.high), bare_slope);
    for (const PointSource& s : sources) sizes->SetH(netgen_point(s.position), s.metric.xx);
    return [=](std::span<const Point> x, std::span<double> out) {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = sizes->GetH(netgen_point(x[i]));
    };
}

template <int order>
Loop bare_array(const ControlSpace& field) {
    constexpr std::size_t nodes = order == 0 ? bare_voxels : bare_voxels + 1;
    const auto lengths = std::make_shared<std::vector<float>>(nodes * nodes * nodes);
    for_each_node<order>(field, [&](std::size_t i, std::size_t j, std::size_t k, double h) {
        (*lengths)[(k * nodes + j) * nodes + i] = static_cast<float>(h);
    });
    return [lengths](std::span<const Point> x, std::span<double> out) {
        const float* const first = lengths->data();
        for (std::size_t n = 0; n < x.size(); ++n) {
            const Vector t = in_voxels(x[n]);
            const auto cell = [&](Axis a) {
                return std::min(static_cast<std::size_t>(t[a]), std::size_t{bare_voxels - 1});
            };
            const std::size_t i = cell(0), j = cell(1), k = cell(2);
            const float* const low = first + (k * nodes + j) * nodes + i;
            if constexpr (order == 0) {
                out[n] = static_cast<double>(*low);
            } else {
                const double u = t.x() - static_cast<double>(i), v = t.y() - static_cast<double>(j),
                             w = t.z() - static_cast<double>(k);
                const auto row = [u](const float* at) { return (1 - u) * at[0] + u * at[1]; };
                const auto layer = [&](const float* at) {
                    return (1 - v) * row(at) + v * row(at + nodes);
                };
                out[n] = (1 - w) * layer(low) + w * layer(low + nodes * nodes);
            }
        }
    };
}

template <int order>
Loop bare_openvdb(const ControlSpace& field) {
    const auto grid = float_grid<order>(field);
    return [grid](std::span<const Point> x, std::span<double> out) {
        const auto read = grid->getConstAccessor();
        for (std::size_t n = 0; n < x.size(); ++n) {
            const Vector t = in_voxels(x[n]);
            if constexpr (order == 0) {
                out[n] = static_cast<double>(read.getValue(openvdb::Coord(
                    static_cast<int>(t.x()), static_cast<int>(t.y()), static_cast<int>(t.z()))));
            } else {
                out[n] = static_cast<double>(
                    openvdb::tools::BoxSampler::sample(read, openvdb::Vec3d(t.x(), t.y(), t.z())));
            }
        }
    };
}

template <int order>
Loop bare_nanovdb(const ControlSpace& field) {
    using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;
    const auto handle = std::make_shared<Handle>(nanovdb::openToNanoVDB(*float_grid<order>(field)));
    return [handle](std::span<const Point> x, std::span<double> out) {
        auto read = handle->template grid<float>()->getAccessor();
        const auto sampler = nanovdb::createSampler<order>(read);
        for (std::size_t n = 0; n < x.size(); ++n) {
            const Vector t = in_voxels(x[n]) - Vector::Constant(order == 0 ? 0.5 : 0);
            out[n] = static_cast<double>(sampler(nanovdb::Vec3d(t.x(), t.y(), t.z())));
        }
    };
}

// Places in CGAL's own order, each searched from the one before.
Loop bare_tets(const ControlSpace& field, std::span<const PointSource> sources) {
    const auto mesh = tetrahedra(field, sources);
    return [=](std::span<const Point> x, std::span<double> out) {
        using Numbered = std::pair<Kernel::Point_3, std::size_t>;
        std::vector<Numbered> sorted;
        for (const Point& p : x) sorted.emplace_back(place(p), sorted.size());
        CGAL::spatial_sort(
            sorted.begin(), sorted.end(),
            CGAL::Spatial_sort_traits_adapter_3<Kernel,
                                                CGAL::First_of_pair_property_map<Numbered>>());
        Mesh::Cell_handle cell;
        for (const auto& [p, i] : sorted) {
            cell = mesh->locate(p, cell);
            double sum = 0, volume = 0;
            for (int k = 0; k < 4; ++k) {
                std::array<Kernel::Point_3, 4> corners;
                for (int c = 0; c < 4; ++c) {
                    corners[static_cast<std::size_t>(c)] = c == k ? p : cell->vertex(c)->point();
                }
                const double part = CGAL::volume(corners[0], corners[1], corners[2], corners[3]);
                sum += part * cell->vertex(k)->info();
                volume += part;
            }
            out[i] = sum / volume;
        }
    };
}

Loop bare_structured(const ControlSpace& space) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("peers-overhead-{}", ::getpid());
    std::ofstream file(path);
    fmt::print(file, "-1 -1 -1\n{0} {0} {0}\n{1} {1} {1}\n", bare_voxel, bare_voxels + 1);
    for (int i = 0; i <= bare_voxels; ++i) {
        for (int j = 0; j <= bare_voxels; ++j) {
            for (int k = 0; k <= bare_voxels; ++k) {
                const Point x = bare_domain.low + bare_voxel * Vector(i, j, k);
                fmt::print(file, "{}\n", sample_at(space, x).xx);
            }
        }
    }
    file.close();
    Loop loop = bare_gmsh<StructuredField>("Structured", [&](int tag) {
        gmsh::model::mesh::field::setString(tag, "FileName", path);
        gmsh::model::mesh::field::setNumber(tag, "TextFormat", 1);
    });
    double read = 0;
    loop({&bare_domain.low, 1}, {&read, 1});
    std::filesystem::remove(path);
    return loop;
}

Loop bare_view(const ControlSpace& space, std::span<const PointSource> sources) {
    const auto mesh = tetrahedra(space, sources);
    std::vector<double> data;
    for (const auto& cell : mesh->finite_cell_handles()) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < 4; ++i) data.push_back(cell->vertex(i)->point()[axis]);
        }
        for (int i = 0; i < 4; ++i) data.push_back(cell->vertex(i)->info());
    }
    const int view = gmsh::view::add("bare");
    gmsh::view::addListData(view, "SS", static_cast<int>(mesh->number_of_finite_cells()), data);
    return bare_gmsh<PostViewField>(
        "PostView", [&](int tag) { gmsh::model::mesh::field::setNumber(tag, "ViewTag", view); });
}

// To be called once the adapter has started MPI. The forest lives until the program ends.
Loop bare_p4est(const ControlSpace& octree) {
    p8est_t* forest = p8est_new_ext(sc_MPI_COMM_SELF, p8est_connectivity_new_unitcube(), 0, 0, 1, 0,
                                    nullptr, const_cast<ControlSpace*>(&octree));
    p8est_refine(forest, 1, is_cut, nullptr);
    sc_array_t* leaves = &p8est_tree_array_index(forest->trees, 0)->quadrants;
    std::vector<double> lengths;
    for (std::size_t i = 0; i < leaves->elem_count; ++i) {
        lengths.push_back(sample_at(octree, centre(*p8est_quadrant_array_index(leaves, i))).xx);
    }
    return [=](std::span<const Point> x, std::span<double> out) {
        p8est_quadrant_t place{};
        place.level = P8EST_MAXLEVEL;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Vector t = (x[i] - bare_domain.low) * (P8EST_ROOT_LEN / 2.0);
            place.x = static_cast<p4est_qcoord_t>(t.x());
            place.y = static_cast<p4est_qcoord_t>(t.y());
            place.z = static_cast<p4est_qcoord_t>(t.z());
            out[i] = lengths[static_cast<std::size_t>(p8est_find_higher_bound(leaves, &place, 0))];
        }
    };
}

template Loop bare_array<0>(const ControlSpace&);
template Loop bare_array<1>(const ControlSpace&);
template Loop bare_openvdb<0>(const ControlSpace&);
template Loop bare_openvdb<1>(const ControlSpace&);
template Loop bare_nanovdb<0>(const ControlSpace&);
template Loop bare_nanovdb<1>(const ControlSpace&);

}  // namespace controlspace

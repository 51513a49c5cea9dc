// SPDX-License-Identifier: Apache-2.0
#include "cones/quadric_tree.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "metric/draw.h"
#include "metric/largest_within.h"

namespace controlspace::quadric_tree_test {
namespace {

using Sources = std::vector<PointSource>;

struct Scene {
    std::string name;
    std::function<PointSource(Draw&, double)> draw;  ///< of an anisotropy
};

const std::vector<Scene>& scenes() {
    static const std::vector<Scene> all{
        {"scattered",
         [](Draw& draw, double anisotropy) {
             return PointSource{draw.vector(),
                                draw.metric(std::pow(10, draw.uniform(-2, 0)), anisotropy)};
         }},
        {"sphere",
         [](Draw& draw, double anisotropy) {
             const Vector normal = draw.vector().normalized();
             return PointSource{0.8 * normal, layer_metric(normal, 0.01, 0.01 * anisotropy)};
         }},
        {"plane",
         [](Draw& draw, double anisotropy) {
             return PointSource{{draw.uniform(-1, 1), draw.uniform(-1, 1), 0},
                                layer_metric(Vector(0, 0, 1), 0.01, 0.01 * anisotropy)};
         }},
        {"uneven clusters on a line",
         [](Draw& draw, double) {
             const double u = draw.uniform(0, 1);
             const double x = u < 0.98 ? 0.001 * draw.uniform(0, 1) + (u < 0.45 ? 0.0 : 0.3) : 1.0;
             const double h = u < 0.45 ? 0.01 : std::pow(10, draw.uniform(-1, 1));
             return PointSource{{x, 0, 0}, {h, h, 2 * h, 0, 0, 0}};
         }},
        {"one place",
         [](Draw& draw, double anisotropy) {
             return PointSource{{0.1, 0.2, 0.7},
                                draw.metric(std::pow(10, draw.uniform(-2, 0)), anisotropy)};
         }},
        {"ratios of their own",
         [](Draw& draw, double anisotropy) {
             return PointSource{draw.vector(), draw.metric(0.1, anisotropy), draw.uniform(1, 2)};
         }},
        {"far from the origin",
         [](Draw& draw, double anisotropy) {
             return PointSource{Vector::Constant(1e5) + draw.vector(),
                                draw.metric(0.1, anisotropy)};
         }},
    };
    return all;
}

// By how much H exceeds the cone, in squared lengths.
double growth(const PointSource& source, double g, const Point& p, const Eigen::Matrix3d& h) {
    const LongMatrix inverse = long_matrix(source.metric).inverse();
    const auto v = p.cast<long double>() - source.position.cast<long double>();
    const long double factor =
        1 + (static_cast<long double>(cone_growth(source, g)) - 1) * (inverse * v).norm();
    const LongMatrix k = inverse * h.cast<long double>() / factor;
    return static_cast<double>(LongSolver(k.transpose() * k).eigenvalues()[2]);
}

// Indices of the sources below a node or leaf.
void gather(const QuadricTree& tree, std::uint32_t number, std::vector<std::uint32_t>& below) {
    if (tree.is_leaf(number)) {
        const std::size_t first = lane_count * tree.first_vector(number);
        const std::size_t end = std::min(first + QuadricTree::leaf_size, tree.indices().size());
        for (std::size_t i = first; i < end; ++i) below.push_back(tree.indices()[i]);
        return;
    }
    const QuadricNode& node = tree.node(number);
    for (std::uint32_t c = 0; c < node.child_count; ++c) gather(tree, node.first_child + c, below);
}

struct Built {
    QuadricTree tree;
    double uncertainty;
};

Built tree_over(const Sources& sources, double g) {
    std::vector<ConeTreeItem> items;
    double anisotropy = 1;
    for (std::uint32_t i = 0; i < sources.size(); ++i) {
        const auto of_source = eigen_frame(sources[i].metric).lengths;
        anisotropy = std::max(anisotropy, of_source[2] / of_source[0]);
        const Point& q = sources[i].position;
        items.push_back({{q.x(), q.y(), q.z(), of_source[0] / (g - 1)}, i});
    }
    const double uncertainty = 4096 * std::numeric_limits<double>::epsilon() * anisotropy;
    return {QuadricTree(std::move(items), sources, uncertainty, g), uncertainty};
}

}  // namespace

TEST_CASE("quadric tree: holds each source once, and knows parents") {
    Draw draw(71);
    for (const int size : {1, 8, 9, 16, 17, 128, 129, 1000, 3000}) {
        CAPTURE(size);
        Sources sources;
        for (int i = 0; i < size; ++i) sources.push_back(scenes()[0].draw(draw, 3));
        const QuadricTree tree = tree_over(sources, 1.25).tree;
        std::vector<std::uint32_t> below;
        gather(tree, 0, below);
        std::sort(below.begin(), below.end());
        bool is_each_there = below.size() == sources.size();
        for (std::size_t i = 0; is_each_there && i < below.size(); ++i) {
            is_each_there = below[i] == i;
        }
        CHECK(is_each_there);
        CHECK(tree.parent(0) == 0);
        for (std::uint32_t n = 0; !tree.is_leaf(n); ++n) {
            const QuadricNode& node = tree.node(n);
            CHECK(node.child_count >= 2);
            for (std::uint32_t c = 0; c < node.child_count; ++c) {
                CHECK(tree.parent(node.first_child + c) == n);
            }
        }
    }
}

TEST_CASE("quadric tree: nothing is passed over that has an exceeded cone") {
    for (unsigned seed = 0; seed < 30; ++seed) {
        Draw draw(seed);
        const Scene& scene = scenes()[seed % scenes().size()];
        const double anisotropy = std::pow(10, draw.uniform(0, seed % 5 == 4 ? 6 : 3));
        const double g = 1 + std::pow(10, draw.uniform(-2, seed % 3 == 0 ? 2 : 0.3));
        CAPTURE(scene.name, seed, anisotropy, g);
        Sources sources;
        const int size = static_cast<int>(draw.uniform(17, 600));
        for (int i = 0; i < size; ++i) sources.push_back(scene.draw(draw, anisotropy));
        const auto [tree, uncertainty] = tree_over(sources, g);
        const auto any = [&] { return sources[static_cast<std::size_t>(draw.uniform(0, size))]; };
        int missed = 0;
        int idle = 0;
        for (int place = 0; place < 12; ++place) {
            const PointSource near = any();
            const Point p = place % 3 == 0 ? near.position
                            : place % 3 == 1
                                ? Point(near.position + 2 * draw.vector())
                                : Point(near.position + 3 * near.metric.matrix() * draw.vector());
            const PointSource like = any();
            Eigen::Matrix3d h = place % 2 == 0 ? draw.metric(1, 10).matrix()
                                               : cone_factor(like, g, p) * like.metric.matrix();
            if (place % 4 == 3) h = h * draw.rotation();
            std::vector<double> growths;
            for (const PointSource& s : sources) growths.push_back(growth(s, g, p, h));
            const double worst = *std::max_element(growths.begin(), growths.end());
            const Exceeding exceeding(p, h);
            for (const double limit : {0.3 * worst, 0.99 * worst, (1 - 1e-6) * worst}) {
                for (std::size_t v = 0; v < tree.vectors().size(); ++v) {
                    double most = 0;
                    const std::size_t end =
                        std::min<std::size_t>((v + 1) * lane_count, sources.size());
                    for (std::size_t i = v * lane_count; i < end; ++i) {
                        most = std::max(most, growths[tree.indices()[i]]);
                    }
                    if (!may_exceed(tree.vectors()[v], exceeding, limit)) {
                        missed += most > (1 + 1e-12 + 1e-13 * anisotropy) * limit ? 1 : 0;
                    } else {
                        idle += most < 0.99 * limit ? 1 : 0;
                    }
                }
                for (std::uint32_t n = 0; !tree.is_leaf(n); ++n) {
                    const unsigned bits = children_exceeded(tree.node(n), exceeding, limit).bits;
                    for (std::uint32_t c = 0; c < tree.node(n).child_count; ++c) {
                        if ((bits >> c & 1) != 0) continue;
                        std::vector<std::uint32_t> below;
                        gather(tree, tree.node(n).first_child + c, below);
                        for (const std::uint32_t i : below) {
                            missed += growths[i] > (1 + 1e-12 + 1e-13 * anisotropy) * limit ? 1 : 0;
                        }
                    }
                }
            }
        }
        CHECK(missed == 0);
        if (anisotropy < 1e3) CHECK(idle == 0);
    }
}

}  // namespace controlspace::quadric_tree_test

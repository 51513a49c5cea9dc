// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <vector>

#include "controlspace/geometry/extent.h"
#include "files/output_file.h"
#include "files/text_file.h"
#include "io/text/bisected_box.h"
#include "io/text/cells.h"
#include "io/text/lengths_at.h"
#include "io/text/scanner.h"
#include "io/text/size_files.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Tetrahedra in which the field is off by more than `tolerance` of what is linear: at the middles
/// of edges, or at the centre.
std::vector<std::size_t> not_linear(const ControlSpace& space, const BisectedBox& mesh,
                                    std::span<const double> lengths, double tolerance) {
    constexpr std::size_t places = 7, at_once = 1 << 15;
    std::vector<std::size_t> found;
    const std::vector<std::size_t> all = mesh.leaves();
    std::vector<Point> x;
    std::vector<double> linear;
    for (std::size_t first = 0; first < all.size(); first += at_once) {
        const auto some = std::span(all).subspan(first, std::min(at_once, all.size() - first));
        x.clear();
        linear.clear();
        for (const std::size_t t : some) {
            const BisectedBox::Corners& c = mesh.corners(t);
            Point centre = Point::Zero();
            double mean = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                centre += 0.25 * mesh.points()[c[i]];
                mean += 0.25 * lengths[c[i]];
                for (std::size_t j = i + 1; j < 4; ++j) {
                    x.push_back(0.5 * (mesh.points()[c[i]] + mesh.points()[c[j]]));
                    linear.push_back(0.5 * (lengths[c[i]] + lengths[c[j]]));
                }
            }
            x.push_back(centre);
            linear.push_back(mean);
        }
        const std::vector<double> exact = lengths_at(space, x).values;
        for (std::size_t i = 0; i < some.size(); ++i) {
            for (std::size_t p = places * i; p < places * (i + 1); ++p) {
                if (std::abs(linear[p] - exact[p]) <= tolerance * exact[p]) continue;
                found.push_back(some[i]);
                break;
            }
        }
    }
    return found;
}

std::filesystem::path with_ending(std::filesystem::path base, const char* ending) {
    return base += ending;
}

}  // namespace

std::vector<Point> read_tetgen_points(const std::filesystem::path& path) {
    const std::string text = read_text_file(path);
    Scanner file(text, path, "#");
    const auto count = file.number<std::size_t>("the number of points");
    if (count > 0 && file.number<std::size_t>("the dimension") != 3) {
        refuse_at(path, "points of a plane: TetGen's have three coordinates");
    }
    file.line();
    file.require_room("points", count, 7);  // "0 0 0 0"
    std::vector<Point> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        file.number<std::size_t>({"the number of point", i});
        for (double& x : points[i]) x = file.number<double>({"point", i});
        file.line();  // attributes and markers
    }
    return points;
}

SizeFile write_tetgen_background(const std::filesystem::path& base, const ControlSpace& space) {
    // Of bisections after those for the cells; three halve all edges.
    constexpr double tolerances[] = {0.02, 0.02, 0.02, 0.05, 0.05, 0.05};
    constexpr std::size_t enough = 2'000'000;  // points
    if (flat_axis(space.domain())) {
        refuse_at(base,
                  "TetGen's background mesh fills a volume, and the domain {} is a plane: "
                  "write another format",
                  to_string(space.domain()));
    }
    BisectedBox mesh(space.domain());
    for (const Box& cell : elements_of(space)) mesh.refine_to(cell, cell.centre());
    mesh.close();
    Lengths lengths = lengths_at(space, mesh.points());
    for (const double tolerance : tolerances) {
        if (mesh.points().size() >= enough) break;
        mesh.refine(not_linear(space, mesh, lengths.values, tolerance));
        mesh.close();
        const auto added = mesh.points().subspan(lengths.values.size());
        const std::vector<double> there = lengths_at(space, added).values;
        lengths.values.insert(lengths.values.end(), there.begin(), there.end());
    }

    OutputFile node(with_ending(base, ".node")), ele(with_ending(base, ".ele")),
        mtr(with_ending(base, ".mtr"));
    node.print("{} 3 0 0\n", mesh.points().size());
    mtr.print("{} 1\n", mesh.points().size());
    for (std::size_t i = 0; i < mesh.points().size(); ++i) {
        const Point& x = mesh.points()[i];
        node.print("{} {} {} {}\n", i + 1, x.x(), x.y(), x.z());
        mtr.print("{}\n", lengths.values[i]);
    }
    const std::vector<std::size_t> leaves = mesh.leaves();
    ele.print("{} 4 0\n", leaves.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const BisectedBox::Corners& c = mesh.corners(leaves[i]);
        ele.print("{} {} {} {} {}\n", i + 1, c[0] + 1, c[1] + 1, c[2] + 1, c[3] + 1);
    }
    for (OutputFile* file : {&node, &ele, &mtr}) file->finish();
    for (OutputFile* file : {&node, &ele, &mtr}) file->commit();

    const auto linear = [&](const Point& x) {
        const BisectedBox::Place place = mesh.place_of(x);
        const BisectedBox::Corners& c = mesh.corners(place.tetrahedron);
        double length = 0;
        for (std::size_t i = 0; i < 4; ++i) length += place.weights[i] * lengths.values[c[i]];
        return length;
    };
    return {mesh.points().size(), lengths.has_tensors, usual_factor(space, linear)};
}

}  // namespace controlspace

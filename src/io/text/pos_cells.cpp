#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "controlspace/geometry/subdivision.h"
#include "controlspace/space/sample_parallel.h"
#include "files/output_file.h"
#include "io/text/cells.h"
#include "io/text/metric_rows.h"
#include "io/text/pos.h"

namespace controlspace {
namespace {

/// Boxes with the metrics at their corners, eight each.
struct Hexahedra {
    std::vector<Box> boxes;
    std::vector<Metric> metrics;
};

/// In units of a box's edges: its corners, its centre, and the middles of faces and edges.
const std::vector<Vector>& places() {
    static const std::vector<Vector> all = [] {
        std::vector<Vector> t;
        for (int c = 0; c < 8; ++c) t.emplace_back(c & 1, c >> 1 & 1, c >> 2 & 1);
        for (int i = 0; i < 27; ++i) {
            const Vector halves(i % 3, i / 3 % 3, i / 9);
            if ((halves.array() == 1).any()) t.push_back(halves / 2);
        }
        return t;
    }();
    return all;
}

/// Metrics at the places of each box, all a little inside, since a field may jump at faces.
std::vector<Metric> at_places(const ControlSpace& space, std::span<const Box> boxes) {
    constexpr double inside = 1e-6;
    std::vector<Point> x;
    for (const Box& box : boxes) {
        for (const Vector& t : places()) {
            const Point place = box.low + t.cwiseProduct(box.edges());
            x.push_back(place + inside * (box.centre() - place));
        }
    }
    std::vector<Metric> metrics(x.size());
    sample_parallel(space, x, metrics);
    return metrics;
}

double trilinear(std::span<const Metric> corners, const Vector& t) {
    double length = 0;
    for (std::size_t c = 0; c < 8; ++c) {
        double weight = 1;
        for (Axis a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? t[a] : 1 - t[a];
        length += weight * corners[c].xx;
    }
    return length;
}

/// Whether the lengths at all places of a box are within 1 % of what those at its corners give.
bool is_trilinear(std::span<const Metric> at) {
    constexpr double tolerance = 0.01;
    for (std::size_t i = 8; i < at.size(); ++i) {
        const double length = trilinear(at.first(8), places()[i]);
        if (std::abs(length - at[i].xx) > tolerance * at[i].xx) return false;
    }
    return true;
}

/// The cells of a structure; those of isotropic lengths that are not trilinear are halved.
Hexahedra hexahedra_of(const ControlSpace& space) {
    constexpr int most_halvings = 2;
    constexpr std::size_t at_once = 4096;
    Hexahedra all;
    std::vector<Box> boxes = elements_of(space);
    for (int halvings = 0; !boxes.empty(); ++halvings) {
        std::vector<Box> parts;
        for (std::size_t first = 0; first < boxes.size(); first += at_once) {
            const auto some =
                std::span(boxes).subspan(first, std::min(at_once, boxes.size() - first));
            const std::vector<Metric> metrics = at_places(space, some);
            for (std::size_t i = 0; i < some.size(); ++i) {
                const auto at = std::span(metrics).subspan(i * places().size(), places().size());
                const Subdivision cut = octants(some[i]);
                if (halvings < most_halvings && cut.is_proper() &&
                    std::ranges::all_of(at, is_isotropic) && !is_trilinear(at)) {
                    for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
                } else {
                    all.boxes.push_back(some[i]);
                    all.metrics.insert(all.metrics.end(), at.begin(), at.begin() + 8);
                }
            }
        }
        boxes = std::move(parts);
    }
    return all;
}

}  // namespace

PosCells write_pos_cells(const std::filesystem::path& path, const ControlSpace& space) {
    const Hexahedra all = hexahedra_of(space);
    const bool isotropic = std::ranges::all_of(all.metrics, is_isotropic);
    const std::vector<int> corners = cell_corners(space.domain());
    const bool is_flat = corners.size() == 4;
    const std::string_view type = isotropic ? (is_flat ? "SQ" : "SH") : is_flat ? "TQ" : "TH";
    std::vector<double> coordinates, values;
    OutputFile file(path);
    file.write("View \"controlspace\" {\n");
    for (std::size_t i = 0; i < all.boxes.size(); ++i) {
        coordinates.clear();
        values.clear();
        for (const int c : corners) {
            const Point x = corner(all.boxes[i], c);
            coordinates.insert(coordinates.end(), x.begin(), x.end());
            const Metric& m = all.metrics[8 * i + static_cast<std::size_t>(c)];
            if (isotropic) {
                values.push_back(m.xx);
            } else {
                const auto numbers = numbers_of(m, matrix_rows);
                values.insert(values.end(), numbers.begin(), numbers.end());
            }
        }
        file.print("{}({}){{{:.10g}}};\n", type, fmt::join(coordinates, ","),
                   fmt::join(values, ","));
    }
    file.write("};\n");
    file.commit();
    return {all.boxes.size(), !isotropic};
}

}  // namespace controlspace

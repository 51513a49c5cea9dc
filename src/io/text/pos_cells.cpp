// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/metric/blend.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/riemannian.h"
#include "controlspace/space/sample_parallel.h"
#include "files/output_file.h"
#include "io/text/cells.h"
#include "io/text/pos.h"

namespace controlspace {
namespace {

/// A box, with the numbers of the view at its corners: M of isotropic metrics, otherwise M^-2.
struct Cell {
    Box box;
    std::array<Metric, 8> corners;
    double off = 0;  ///< how much of its places the view answers wrongly, as PosCells::off
};

/// In units of a box's edges: its corners, its centre, and the middles of faces and edges.
const std::vector<Vector>& places() {
    static const std::vector<Vector> all = [] {
        std::vector<Vector> t;
        t.reserve(27);
        for (int c = 0; c < 8; ++c) t.emplace_back(c & 1, c >> 1 & 1, c >> 2 & 1);
        for (int i = 0; i < 27; ++i) {
            const int row = i / 3, layer = row / 3;
            const Vector halves(i % 3, row % 3, layer);
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
    return sample_parallel(space, x);
}

/// The cells of a view of a structure. Those where the view is off are halved.
class View {
public:
    explicit View(const ControlSpace& space) : space_(space), volume_(measure(space.domain())) {
        const std::vector<Box> boxes = elements_of(space);
        for_each(boxes, [&](const Box& box, std::span<const Metric> at) {
            has_tensors_ = has_tensors_ || !std::ranges::all_of(at, is_isotropic);
            const double share = measure(box) / static_cast<double>(at.size());
            for (const Metric& m : at) elements_ += share / m.matrix().determinant();
        });
        add(boxes);
        while (halve()) {
        }
    }

    bool has_tensors() const { return has_tensors_; }
    const std::vector<Cell>& cells() const { return cells_; }

private:
    // Halves the cells that are most off until few places are. Returns whether some were halved.
    bool halve() {
        constexpr double few = 0.01;
        // Some 300 MB; of tensors 200.
        const std::size_t most = has_tensors_ ? 200'000 : 1'000'000;
        std::ranges::sort(cells_, std::less(), &Cell::off);
        double off = 0;
        std::size_t kept = 0;
        while (kept < cells_.size() && off + cells_[kept].off <= few) off += cells_[kept++].off;
        std::vector<Box> parts;
        std::size_t left = cells_.size();
        for (; left > kept && left + parts.size() < most; --left) {
            const Subdivision cut = octants(cells_[left - 1].box);
            if (!cut.is_proper()) break;
            for (int c = 0; c < cut.children(); ++c) parts.push_back(cut.child(c));
        }
        cells_.resize(left);
        add(parts);
        return !parts.empty();
    }

    void add(std::span<const Box> boxes) {
        for_each(boxes, [&](const Box& box, std::span<const Metric> at) {
            cells_.push_back(cell_of(box, at));
        });
    }

    /// visit(box, metrics at its places)
    template <class Visit>
    void for_each(std::span<const Box> boxes, Visit&& visit) const {
        constexpr std::size_t at_once = 4096;
        const std::size_t n = places().size();
        for (std::size_t first = 0; first < boxes.size(); first += at_once) {
            const auto some = boxes.subspan(first, std::min(at_once, boxes.size() - first));
            const std::vector<Metric> metrics = at_places(space_, some);
            for (std::size_t i = 0; i < some.size(); ++i) {
                visit(some[i], std::span(metrics).subspan(i * n, n));
            }
        }
    }

    Cell cell_of(const Box& box, std::span<const Metric> at) const {
        static const double lengths_off = nonconformity_of_factor(1.01);
        static const double tensors_off = nonconformity_along(1.01);
        Cell cell{box, {}};
        std::ranges::transform(at.first(8), cell.corners.begin(), [&](const Metric& m) {
            return has_tensors_ ? to_riemannian(m) : m;
        });
        for (std::size_t i = 8; i < at.size(); ++i) {
            const Metric read = blend_lengths(
                corner_weights(places()[i]), [&](std::size_t c) -> auto& {
                    return cell.corners[c];
                });
            const auto m = has_tensors_ ? from_riemannian(read) : read;
            const double limit = has_tensors_ ? tensors_off : lengths_off;
            if (m && directional_nonconformity(*m, at[i]) <= limit) continue;
            cell.off += 1 / volume_ + 1 / (at[i].matrix().determinant() * elements_);
        }
        cell.off *= measure(box) / static_cast<double>(at.size() - 8);
        return cell;
    }

    const ControlSpace& space_;
    bool has_tensors_ = false;
    double volume_, elements_ = 0;
    std::vector<Cell> cells_;
};

}  // namespace

PosCells write_pos_cells(const std::filesystem::path& path, const ControlSpace& space) {
    const View view(space);
    const bool isotropic = !view.has_tensors();
    const std::vector<int> corners = cell_corners(space.domain());
    const bool is_flat = corners.size() == 4;
    const std::string_view type = isotropic ? (is_flat ? "SQ" : "SH") : is_flat ? "TQ" : "TH";
    std::vector<double> coordinates, values;
    OutputFile file(path);
    file.write("View \"controlspace\" {\n");
    double off = 0;
    for (const Cell& cell : view.cells()) {
        off += cell.off;
        coordinates.clear();
        values.clear();
        for (const int c : corners) {
            const Point x = corner(cell.box, c);
            coordinates.insert(coordinates.end(), x.begin(), x.end());
            const Metric& m = cell.corners[static_cast<std::size_t>(c)];
            if (isotropic) {
                values.push_back(m.xx);
            } else {
                values.insert(values.end(), {m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz});
            }
        }
        file.print("{}({}){{{:.10g}}};\n", type, fmt::join(coordinates, ","),
                   fmt::join(values, ","));
    }
    file.write("};\n");
    file.commit();
    return {view.cells().size(), !isotropic, off};
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkStaticCellLocator.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/io/read_vtk_sources.h"
#include "io/vtk/vtk_metrics.h"
#include "refuse.h"

namespace controlspace {
namespace {

Box bounds_of(vtkDataSet& grid) {
    std::array<double, 6> bounds{};
    grid.GetBounds(bounds.data());
    return {{bounds[0], bounds[2], bounds[4]}, {bounds[1], bounds[3], bounds[5]}};
}

/// Constant in each cell, or by the cells' shape functions between points.
class CellField final : public ControlSpace {
public:
    CellField(VtkMetrics data, double finest) : data_(std::move(data)), finest_(finest) {
        domain_ = bounds_of(*data_.grid);
        move_to_unit_box();
        locator_->SetDataSet(data_.grid);
        locator_->BuildLocator();
        largest_cell_ = static_cast<std::size_t>(data_.grid->GetMaxCellSize());
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const vtkNew<vtkGenericCell> cell;
        std::vector<double> weights(largest_cell_);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Point p = to_grid_ * (x[i] - origin_);
            out[i] = at(nearest_in(grid_box_, p), cell, weights);
        }
    }
    Box domain() const override { return domain_; }

private:
    /// Moves the grid to the origin, scales it to a longest edge of 1 and turns an image's axes to
    /// the coordinates'; places will be moved with it. VTK's tolerances are absolute, and its
    /// voxels are along the coordinates' axes even where those of their image are not.
    void move_to_unit_box() {
        const double unit = 1 / domain_.edges().maxCoeff();
        origin_ = domain_.low;
        to_grid_ = unit * Eigen::Matrix3d::Identity();
        if (auto* image = vtkImageData::SafeDownCast(data_.grid)) {
            origin_ = Point(image->GetOrigin());
            to_grid_ = unit * axes_of(*image).inverse();
            const Vector spacing = unit * Vector(image->GetSpacing());
            image->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1);
            image->SetOrigin(0, 0, 0);
            image->SetSpacing(spacing.data());
        } else if (auto* set = vtkPointSet::SafeDownCast(data_.grid)) {
            const vtkNew<vtkPoints> points;
            points->SetDataTypeToDouble();
            points->SetNumberOfPoints(set->GetNumberOfPoints());
            for (vtkIdType i = 0; i < set->GetNumberOfPoints(); ++i) {
                const Point p = to_grid_ * (Point(set->GetPoint(i)) - origin_);
                points->SetPoint(i, p.data());
            }
            set->SetPoints(points);
        }
        grid_box_ = bounds_of(*data_.grid);
    }

    Metric at(Point x, vtkGenericCell* cell, std::vector<double>& weights) const {
        Point inside;
        int part = 0;
        double distance = 0;
        vtkIdType id = locator_->FindCell(x.data(), 0, cell, inside.data(), weights.data());
        if (id < 0) {  // between cells, or beside an uneven boundary
            Point nearest;
            locator_->FindClosestPoint(x.data(), nearest.data(), cell, id, part, distance);
            cell->EvaluatePosition(nearest.data(), nullptr, part, inside.data(), distance,
                                   weights.data());
        }
        if (!data_.at_points) return data_.metrics[static_cast<std::size_t>(id)];
        const auto count = static_cast<std::size_t>(cell->GetNumberOfPoints());
        const std::span<double> used = std::span(weights).first(count);
        // Shape functions of higher order are negative in places, and values may be smaller there
        // than any at a point, down to none: then they are a mean.
        if (std::ranges::min(used) < 0) {
            const Metric sum = weighted(cell, used);
            if (is_source_metric(sum) && eigen_frame(sum).lengths[0] >= finest_) return sum;
            for (double& weight : used) weight = std::max(0.0, weight);
        }
        return weighted(cell, used);
    }

    /// The mean of the metrics at the points of a cell.
    Metric weighted(vtkGenericCell* cell, std::span<const double> weights) const {
        Metric sum{0, 0, 0, 0, 0, 0};
        double all = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const double weight = weights[k];
            const Metric& m =
                data_.metrics[static_cast<std::size_t>(cell->GetPointId(static_cast<int>(k)))];
            sum = {sum.xx + weight * m.xx, sum.yy + weight * m.yy, sum.zz + weight * m.zz,
                   sum.xy + weight * m.xy, sum.xz + weight * m.xz, sum.yz + weight * m.yz};
            all += weight;
        }
        if (!(all > 0)) return data_.metrics[static_cast<std::size_t>(cell->GetPointId(0))];
        return (1 / all) * sum;
    }

    VtkMetrics data_;
    double finest_;  ///< length at a point or in a cell
    Box domain_;
    Box grid_box_;  ///< of the moved grid
    Point origin_;
    Eigen::Matrix3d to_grid_;
    std::size_t largest_cell_ = 0;  ///< points of a cell, at most
    vtkNew<vtkStaticCellLocator> locator_;
};

}  // namespace

AnalyticField read_vtk_field(const std::filesystem::path& path, const std::string& name) {
    VtkMetrics data = read_vtk_metrics(path, {.array = name}, "--field-grid");
    for (vtkIdType i = 0; i < data.grid->GetNumberOfCells(); ++i) {
        if (data.hidden > 0 || is_hidden(*data.grid, /*at_points=*/false, i)) {
            refuse_at(path, "some of it is hidden (vtkGhostType): save the field without that");
        }
        if (data.grid->GetCell(i)->GetCellDimension() == 3) continue;
        refuse_at(path,
                  "cell {} has no volume, so that nothing is between points: leave "
                  "such cells out, or read points as sources (--sources)",
                  i + 1);
    }
    if (data.grid->GetNumberOfCells() == 0) refuse_at(path, "no cells: nothing to read");
    if (data.grid->IsA("vtkRectilinearGrid") != 0) {
        refuse_at(path, "a rectilinear grid: save it as an unstructured one");
    }
    if (!(bounds_of(*data.grid).edges().maxCoeff() > 0)) {
        refuse_at(path, "all points are at one place: nothing is between them");
    }
    double finest = largest_magnitude;
    for (const Metric& m : data.metrics) finest = std::min(finest, eigen_frame(m).lengths[0]);
    std::vector<Point> places = data.positions;
    return {std::make_shared<CellField>(std::move(data), finest), finest, std::move(places)};
}

}  // namespace controlspace

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkHyperTreeGrid.h>
#include <vtkHyperTreeGridNonOrientedCursor.h>
#include <vtkNew.h>
#include <vtkXMLHyperTreeGridWriter.h>

#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/subdivision.h"
#include "controlspace/io/write_vtk.h"
#include "io/vtk/vtk_fields.h"

namespace controlspace {
namespace {

vtkNew<vtkDoubleArray> ends(const Box& domain, Axis a) {
    vtkNew<vtkDoubleArray> values;
    values->InsertNextValue(domain.low[a]);
    values->InsertNextValue(domain.high[a]);
    return values;
}

/// Subdivides the grid's tree as the space is, and keeps the centre of each box at its number.
void grow(const ControlSpace& space, vtkHyperTreeGridNonOrientedCursor& cursor, const Box& box,
          std::vector<Point>& centres) {
    const auto number = static_cast<std::size_t>(cursor.GetGlobalNodeIndex());
    if (centres.size() <= number) centres.resize(number + 1);
    centres[number] = box.centre();
    const auto cell = space.cell_at(box.centre());
    const Box element = cell.value_or(Box());
    if (element == box) return;
    const Subdivision subdivision = octants(box);
    const bool is_inside = box.contains(element.low) && box.contains(element.high);
    if (!is_inside || !subdivision.is_proper()) {
        throw InputError("only an octree can be written as .htg: choose one, or name a .vtu");
    }
    cursor.SubdivideLeaf();
    for (int c = 0; c < 8; ++c) {
        cursor.ToChild(static_cast<unsigned char>(c));
        grow(space, cursor, subdivision.child(c), centres);
        cursor.ToParent();
    }
}

}  // namespace

void write_octree(const std::filesystem::path& path, const ControlSpace& space) {
    constexpr unsigned points_per_axis = 2;
    vtkNew<vtkHyperTreeGrid> grid;
    grid->Initialize();
    grid->SetDimensions(points_per_axis, points_per_axis, points_per_axis);
    grid->SetBranchFactor(2);
    grid->SetXCoordinates(ends(space.domain(), 0));
    grid->SetYCoordinates(ends(space.domain(), 1));
    grid->SetZCoordinates(ends(space.domain(), 2));
    std::vector<Point> centres;
    vtkNew<vtkHyperTreeGridNonOrientedCursor> cursor;
    constexpr bool create = true;
    grid->InitializeNonOrientedCursor(cursor, 0, create);
    cursor->SetGlobalIndexStart(0);
    grow(space, *cursor, space.domain(), centres);
    std::vector<Metric> metrics(centres.size());
    space.sample(centres, metrics);
    add_metric_arrays(*grid->GetCellData(), metrics);
    vtkNew<vtkXMLHyperTreeGridWriter> writer;
    // VTK 9.1 writes a range over the head of a file of appended data, and of version 2 it does not
    // read arrays of more than one component.
    writer->SetDataModeToBinary();
    writer->SetDataSetMajorVersion(1);
    write_vtk_file(*writer, *grid, path);
}

}  // namespace controlspace

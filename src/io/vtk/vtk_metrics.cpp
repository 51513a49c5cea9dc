// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_metrics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDataSetReader.h>
#include <vtkExecutive.h>
#include <vtkIdList.h>
#include <vtkLogger.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Keeps the first error that VTK's readers report. What they and their helpers say is not printed
/// meanwhile.
class ErrorLog {
public:
    ErrorLog() : verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
        command_->SetClientData(this);
        command_->SetCallback([](vtkObject*, unsigned long, void* self, void* text) {
            static_cast<ErrorLog*>(self)->add(static_cast<const char*>(text));
        });
    }
    ~ErrorLog() { vtkLogger::SetStderrVerbosity(verbosity_); }
    ErrorLog(const ErrorLog&) = delete;
    ErrorLog& operator=(const ErrorLog&) = delete;

    vtkCommand* command() { return command_; }
    const std::string& first() const { return first_; }

private:
    /// Of "ERROR: In ...\nvtkX (0x...): what is wrong\n\n" what is wrong.
    void add(std::string_view text) {
        if (!first_.empty()) return;
        if (const auto colon = text.find("): "); colon != text.npos) text.remove_prefix(colon + 3);
        text = text.substr(0, text.find('\n'));
        // Where no reader, but their pipeline alone complains, it tells of itself.
        first_ = text.starts_with("Algorithm ") ? "it is malformed" : text;
    }

    const vtkLogger::Verbosity verbosity_;
    vtkNew<vtkCallbackCommand> command_;
    std::string first_;
};

template <class Reader>
vtkSmartPointer<vtkDataSet> read_data_set(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    vtkNew<Reader> reader;
    ErrorLog errors;
    for (const auto event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent}) {
        reader->AddObserver(event, errors.command());
        reader->GetExecutive()->AddObserver(event, errors.command());
    }
    if constexpr (std::is_same_v<Reader, vtkDataSetReader>) {
        reader->ReadAllScalarsOn();  // not the first array alone
        reader->ReadAllTensorsOn();
        reader->ReadAllFieldsOn();
    } else {
        reader->SetReaderErrorObserver(errors.command());
        reader->SetParserErrorObserver(errors.command());
    }
    reader->SetFileName(path.c_str());
    try {
        if constexpr (!std::is_same_v<Reader, vtkDataSetReader>) {
            reader->UpdateInformation();
            std::vector<std::uint64_t> steps(
                static_cast<std::size_t>(std::max(1, reader->GetNumberOfTimeSteps())));
            std::iota(steps.begin(), steps.end(), 0);
            const std::string name = options.array.empty() ? path.stem().string() : options.array;
            if (errors.first().empty()) {
                reader->SetTimeStep(
                    static_cast<int>(chosen_step(path, name, steps, options.step, options.remark)));
            }
        }
        reader->Update();
    } catch (const std::bad_alloc&) {
        refuse_at(path, "an array is said to hold more than memory does: is it cut off?");
    }
    if (!errors.first().empty()) refuse_at(path, "VTK cannot read it: {}", errors.first());
    return reader->GetOutput();
}

/// Sizes or metrics, at points or in cells.
struct Values {
    vtkDataArray* array = nullptr;
    bool at_points = true;
};

/// The array of that name, the only one of metrics without a name; of cells where points have none.
/// `option` names one, for messages.
Values array_named(const std::filesystem::path& path, vtkDataSet& grid, const std::string& name,
                   const char* option) {
    std::string all;
    for (const bool at_points : {true, false}) {
        vtkDataSetAttributes* data = grid.GetPointData();
        if (!at_points) data = grid.GetCellData();
        vtkDataArray* found = nullptr;
        std::vector<std::string> names;  // of those that fit
        for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
            vtkDataArray* array = data->GetArray(i);
            if (array == nullptr || array->GetName() == nullptr) continue;  // of texts, or no name
            const std::string its_name = array->GetName();
            all.append(all.empty() ? "" : ", ").append(quote(its_name));
            if (!at_points) all.append(" (of cells)");
            if (name.empty() ? its_name.find(":metric") == its_name.npos : its_name != name)
                continue;
            found = array;
            names.push_back(quote(its_name));
        }
        if (names.size() > 1) {
            refuse_at(path, "{} of its arrays of {} can be meant: name one of {} ({})",
                      names.size(), at_points ? "points" : "cells", fmt::join(names, ", "), option);
        }
        if (found != nullptr) return {found, at_points};
    }
    if (all.empty())
        refuse_at(path, "it has no arrays: give sizes or metrics at points or of cells");
    refuse_at(path, "no array is named {}, there are {}: name one ({})",
              name.empty() ? ":metric" : quote(name), all, option);
}

/// The mean of a cell's points.
Point centre_of(const std::filesystem::path& path, vtkDataSet& grid, vtkIdType cell) {
    vtkNew<vtkIdList> points;
    grid.GetCellPoints(cell, points);
    const vtkIdType n = points->GetNumberOfIds();
    if (n == 0) refuse_at(path, "cell {} has no points: leave it out", cell + 1);
    Point sum = Point::Zero();
    for (vtkIdType k = 0; k < n; ++k) {
        Point x;
        grid.GetPoint(points->GetId(k), x.data());
        sum += x;
    }
    return sum / static_cast<double>(n);
}

}  // namespace

Eigen::Matrix3d axes_of(vtkImageData& image) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
        image.GetDirectionMatrix()->GetData());
}

bool is_hidden(vtkDataSet& grid, bool at_points, vtkIdType i) {
    constexpr int hidden_points = vtkDataSetAttributes::HIDDENPOINT;
    constexpr int hidden_cells =
        vtkDataSetAttributes::HIDDENCELL | vtkDataSetAttributes::REFINEDCELL;
    vtkDataSetAttributes* data = grid.GetPointData();
    if (!at_points) data = grid.GetCellData();
    const auto* marks =
        vtkUnsignedCharArray::SafeDownCast(data->GetArray(vtkDataSetAttributes::GhostArrayName()));
    return marks != nullptr &&
           (marks->GetValue(i) & (at_points ? hidden_points : hidden_cells)) != 0;
}

VtkMetrics read_vtk_metrics(const std::filesystem::path& path, const ReadOptions& options,
                            const char* option) {
    const std::string ending = lower_case_extension(path);
    const bool is_legacy = ending == ".vtk";
    if (read_binary_file(path).find(is_legacy ? "# vtk DataFile" : "<VTKFile") ==
        std::string::npos) {
        refuse_at(path, "{}",
                  is_legacy ? "does not start with '# vtk DataFile': give a file of VTK"
                            : "no VTKFile element: give a file in VTK's XML format");
    }
    const auto grid = ending == ".vtp"   ? read_data_set<vtkXMLPolyDataReader>(path, options)
                      : ending == ".vti" ? read_data_set<vtkXMLImageDataReader>(path, options)
                      : is_legacy        ? read_data_set<vtkDataSetReader>(path, options)
                                  : read_data_set<vtkXMLUnstructuredGridReader>(path, options);
    if (grid == nullptr) refuse_at(path, "it holds no data set that VTK knows: save it again");
    if (auto* image = vtkImageData::SafeDownCast(grid)) {
        const double volume = axes_of(*image).determinant();
        constexpr double least = 1e-6;  // of unit vectors
        if (!(std::abs(volume) > least)) {
            refuse_at(path, "its Direction is no basis of space: give three independent axes");
        }
    }
    const auto [array, at_points] = array_named(path, *grid, options.array, option);
    vtkDataArray& values = *array;
    const vtkIdType count = at_points ? grid->GetNumberOfPoints() : grid->GetNumberOfCells();
    const char* what = at_points ? "point" : "cell";
    if (count == 0) refuse_at(path, "no {}s: nothing to read", what);
    if (values.GetNumberOfTuples() != count) {
        refuse_at(path, "{} {}s, but {} values in {}: is it cut off?", count, what,
                  values.GetNumberOfTuples(), quote(values.GetName()));
    }
    const auto components = static_cast<std::size_t>(values.GetNumberOfComponents());
    if (components != 1 && components != vtk_tensor.numbers && components != matrix_rows.numbers) {
        refuse_at(path, "array {} has {} components: give 1 (sizes), 6 or 9 (tensors)",
                  quote(values.GetName()), components);
    }
    const auto where = [&] { return path.string(); };
    MetricRows metrics(where, components == vtk_tensor.numbers ? vtk_tensor : matrix_rows);
    std::vector<Point> positions;
    std::array<double, 9> numbers{};
    std::size_t hidden = 0;
    for (vtkIdType i = 0; i < count; ++i) {
        if (is_hidden(*grid, at_points, i)) {
            ++hidden;
            continue;
        }
        Point& x = positions.emplace_back();
        if (at_points) {
            grid->GetPoint(i, x.data());
        } else {
            x = centre_of(path, *grid, i);
        }
        require_coordinates(x, what, static_cast<std::size_t>(i) + 1, where);
        values.GetTuple(i, numbers.data());
        metrics.add(std::span(numbers).first(components));
    }
    if (positions.empty()) refuse_at(path, "all {}s are hidden: nothing to read", what);
    return {grid, at_points, std::move(positions), metrics.take(), hidden};
}

}  // namespace controlspace

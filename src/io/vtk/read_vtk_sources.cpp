#include "controlspace/io/read_vtk_sources.h"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkExecutive.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <array>
#include <new>
#include <span>
#include <string_view>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "files/text_file.h"
#include "io/text/metric_rows.h"

namespace controlspace {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
}

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
vtkSmartPointer<vtkDataSet> read_data_set(const std::filesystem::path& path) {
    vtkNew<Reader> reader;
    ErrorLog errors;
    for (const auto event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent}) {
        reader->AddObserver(event, errors.command());
        reader->GetExecutive()->AddObserver(event, errors.command());
    }
    reader->SetReaderErrorObserver(errors.command());
    reader->SetParserErrorObserver(errors.command());
    reader->SetFileName(path.c_str());
    try {
        reader->Update();
    } catch (const std::bad_alloc&) {
        fail(path, "an array is said to hold more than memory does: is it cut off?");
    }
    if (!errors.first().empty()) fail(path, "VTK cannot read it: " + errors.first());
    return reader->GetOutput();
}

/// Sizes or metrics, at points or in cells.
struct Values {
    vtkDataArray* array = nullptr;
    bool at_points = true;
};

/// Arrays of numbers that have a name.
std::vector<vtkDataArray*> arrays_of(vtkDataSetAttributes& data) {
    std::vector<vtkDataArray*> arrays;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data.GetArray(i);
        if (array != nullptr && array->GetName() != nullptr) arrays.push_back(array);
    }
    return arrays;
}

/// The array of that name, the only one of metrics without a name; of cells where points have none.
Values array_named(const std::filesystem::path& path, vtkDataSet& grid, const std::string& name) {
    std::string all;
    for (const bool at_points : {true, false}) {
        const auto arrays =
            at_points ? arrays_of(*grid.GetPointData()) : arrays_of(*grid.GetCellData());
        std::vector<vtkDataArray*> fitting;
        std::vector<std::string> names;
        for (vtkDataArray* array : arrays) {
            const std::string its_name = array->GetName();
            all.append(all.empty() ? "" : ", ").append(quote(its_name));
            if (!at_points) all.append(" (of cells)");
            if (name.empty() ? its_name.find(":metric") == its_name.npos : its_name != name)
                continue;
            fitting.push_back(array);
            names.push_back(its_name);
        }
        if (fitting.empty()) continue;
        const char* kind = at_points ? "arrays of points" : "arrays of cells";
        return {fitting[chosen_array(path, kind, names, name)], at_points};
    }
    if (all.empty()) fail(path, "it has no arrays: give sizes or metrics at points or of cells");
    fail(path, fmt::format("no array is named {}, there are {}: name one (--source-array)",
                           name.empty() ? ":metric" : quote(name), all));
}

/// The mean of a cell's points.
Point centre_of(const std::filesystem::path& path, vtkDataSet& grid, vtkIdType cell) {
    vtkNew<vtkIdList> points;
    grid.GetCellPoints(cell, points);
    const vtkIdType n = points->GetNumberOfIds();
    if (n == 0) fail(path, fmt::format("cell {} has no points: leave it out", cell + 1));
    Point sum = Point::Zero();
    for (vtkIdType k = 0; k < n; ++k) {
        Point x;
        grid.GetPoint(points->GetId(k), x.data());
        sum += x;
    }
    return sum / static_cast<double>(n);
}

}  // namespace

std::vector<PointSource> read_vtk_sources(const std::filesystem::path& path,
                                          const std::string& name) {
    if (read_binary_file(path).find("<VTKFile") == std::string::npos) {
        fail(path, "no VTKFile element: give a file in VTK's XML format");
    }
    const std::string ending = lower_case_extension(path);
    const auto grid = ending == ".vtp"   ? read_data_set<vtkXMLPolyDataReader>(path)
                      : ending == ".vti" ? read_data_set<vtkXMLImageDataReader>(path)
                                         : read_data_set<vtkXMLUnstructuredGridReader>(path);
    const auto [array, at_points] = array_named(path, *grid, name);
    vtkDataArray& values = *array;
    const vtkIdType count = at_points ? grid->GetNumberOfPoints() : grid->GetNumberOfCells();
    const char* what = at_points ? "point" : "cell";
    if (count == 0) fail(path, fmt::format("no {}s: nothing to read", what));
    if (values.GetNumberOfTuples() != count) {
        fail(path, fmt::format("{} {}s, but {} values in {}: is it cut off?", count, what,
                               values.GetNumberOfTuples(), quote(values.GetName())));
    }
    const auto components = static_cast<std::size_t>(values.GetNumberOfComponents());
    if (components != 1 && components != vtk_tensor.numbers && components != matrix_rows.numbers) {
        fail(path, fmt::format("array {} has {} components: give 1 (sizes), 6 or 9 (tensors)",
                               quote(values.GetName()), components));
    }
    const auto where = [&] { return path.string(); };
    MetricRows metrics(where, components == vtk_tensor.numbers ? vtk_tensor : matrix_rows);
    std::vector<Point> positions(static_cast<std::size_t>(count));
    std::array<double, 9> numbers{};
    for (vtkIdType i = 0; i < count; ++i) {
        Point& x = positions[static_cast<std::size_t>(i)];
        if (at_points) {
            grid->GetPoint(i, x.data());
        } else {
            x = centre_of(path, *grid, i);
        }
        require_coordinates(x, what, static_cast<std::size_t>(i) + 1, where);
        values.GetTuple(i, numbers.data());
        metrics.add(std::span(numbers).first(components));
    }
    return sources_from(positions, metrics.take());
}

}  // namespace controlspace

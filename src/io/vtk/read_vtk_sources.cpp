#include "controlspace/io/read_vtk_sources.h"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkDataArray.h>
#include <vtkExecutive.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
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
vtkSmartPointer<vtkPointSet> read_points(const std::filesystem::path& path) {
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

vtkDataArray& array_named(const std::filesystem::path& path, vtkPointData& data,
                          const std::string& name) {
    std::vector<vtkDataArray*> arrays;
    std::vector<std::string> names;
    std::string all;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data.GetArray(i);
        if (array == nullptr || array->GetName() == nullptr) continue;  // of texts, or nameless
        const std::string its_name = array->GetName();
        all += (all.empty() ? "" : ", ") + quote(its_name);
        if (name.empty() && its_name.find(":metric") == its_name.npos) continue;
        arrays.push_back(array);
        names.push_back(its_name);
    }
    if (all.empty()) fail(path, "its points have no arrays: give sizes or metrics at points");
    if (names.empty()) {
        fail(path, fmt::format("no array of points is named :metric, there are {}: name one "
                               "(--source-array)",
                               all));
    }
    return *arrays[chosen_array(path, "arrays of points", names, name)];
}

}  // namespace

std::vector<PointSource> read_vtk_sources(const std::filesystem::path& path,
                                          const std::string& array) {
    if (read_binary_file(path).find("<VTKFile") == std::string::npos) {
        fail(path, "no VTKFile element: give a file in VTK's XML format");
    }
    const auto grid = lower_case_extension(path) == ".vtp"
                          ? read_points<vtkXMLPolyDataReader>(path)
                          : read_points<vtkXMLUnstructuredGridReader>(path);
    vtkDataArray& values = array_named(path, *grid->GetPointData(), array);
    const vtkIdType count = grid->GetNumberOfPoints();
    if (count == 0) fail(path, "no points: nothing to read");
    if (values.GetNumberOfTuples() != count) {
        fail(path, fmt::format("{} points, but {} values in {}: is it cut off?", count,
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
        grid->GetPoint(i, x.data());
        require_coordinates(x, "point", static_cast<std::size_t>(i) + 1, where);
        values.GetTuple(i, numbers.data());
        metrics.add(std::span(numbers).first(components));
    }
    return sources_from(positions, metrics.take());
}

}  // namespace controlspace

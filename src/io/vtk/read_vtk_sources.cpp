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

#include <algorithm>
#include <array>
#include <new>
#include <string_view>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "io/text/metric_rows.h"
#include "io/text/text_file.h"

namespace controlspace {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
}

/// VTK allocates as much as a file says it holds: what it says is checked first.
void require_plausible_counts(const std::filesystem::path& path) {
    const std::string bytes = read_binary_file(path);
    const std::string_view file(bytes);
    if (file.find("<VTKFile") == std::string_view::npos) {
        fail(path, "no VTKFile element: give a file in VTK's XML format");
    }
    // A point is 12 bytes or more, which are compressed to a thousandth at best.
    const std::size_t most = 128 * file.size();
    constexpr std::string_view counter = " NumberOf";
    const std::size_t end = std::min(file.find("<AppendedData"), file.size());
    for (std::size_t at = file.find(counter); at < end; at = file.find(counter, at + 1)) {
        const std::size_t begin = file.find('"', at);
        const std::size_t length = std::min(file.find('"', begin + 1), end) - begin - 1;
        if (begin >= end || length > end) fail(path, "a count is cut off");
        const std::string_view text = file.substr(begin + 1, length);
        std::size_t count = 0;
        if (!parse_number(text, count) || count > most) {
            const auto line = std::count(bytes.begin(), bytes.begin() + std::ptrdiff_t(at), '\n');
            throw InputError(
                fmt::format("{}: {} of {}, but {} bytes cannot hold so many: is it cut off?",
                            place(path, 1 + std::size_t(line)), file.substr(at + 1, begin - at - 2),
                            quote(text), file.size()));
        }
    }
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

vtkDataArray& chosen_array(const std::filesystem::path& path, vtkPointData& data,
                           const std::string& name) {
    std::vector<vtkDataArray*> chosen;
    std::string names;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data.GetArray(i);
        if (array == nullptr || array->GetName() == nullptr) continue;  // of texts, or nameless
        const std::string its_name = array->GetName();
        names += (names.empty() ? "" : ", ") + quote(its_name);
        const bool is_named =
            name.empty() ? its_name.find(":metric") != its_name.npos : its_name == name;
        if (is_named) chosen.push_back(array);
    }
    if (chosen.size() == 1) return *chosen.front();
    if (names.empty()) fail(path, "its points have no arrays: give sizes or metrics at points");
    fail(path, fmt::format("{} arrays of points are {}; there are {}: name one (--source-array)",
                           chosen.size(), name.empty() ? "named :metric" : quote(name), names));
}

std::vector<Metric> metrics_of(const std::filesystem::path& path, vtkDataArray& array) {
    const int components = array.GetNumberOfComponents();
    if (components != 1 && components != 6 && components != 9) {
        fail(path, fmt::format("array {} has {} components: give 1 (sizes), 6 or 9 (tensors)",
                               quote(array.GetName()), components));
    }
    MetricRows metrics(path, components == 6 ? "XX YY ZZ XY YZ XZ" : "by rows");
    std::array<double, 9> t{};
    for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i) {
        array.GetTuple(i, t.data());
        if (components == 1) {
            metrics.add_size(t[0]);
        } else if (components == 6) {
            metrics.add_tensor({t[0], t[1], t[2], t[3], t[5], t[4]});
        } else {
            metrics.add_matrix(t);
        }
    }
    return metrics.take();
}

}  // namespace

std::vector<PointSource> read_vtk_sources(const std::filesystem::path& path,
                                          const std::string& array) {
    require_plausible_counts(path);
    const auto grid = lower_case_extension(path) == ".vtp"
                          ? read_points<vtkXMLPolyDataReader>(path)
                          : read_points<vtkXMLUnstructuredGridReader>(path);
    vtkDataArray& values = chosen_array(path, *grid->GetPointData(), array);
    const vtkIdType count = grid->GetNumberOfPoints();
    if (count == 0) fail(path, "no points: nothing to read");
    if (values.GetNumberOfTuples() != count) {
        fail(path, fmt::format("{} points, but {} values in {}: is it cut off?", count,
                               values.GetNumberOfTuples(), quote(values.GetName())));
    }
    const std::vector<Metric> metrics = metrics_of(path, values);
    std::vector<PointSource> sources(metrics.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        sources[i].metric = metrics[i];
        grid->GetPoint(static_cast<vtkIdType>(i), sources[i].position.data());
        for (const double x : sources[i].position) {
            if (!is_coordinate(x))
                fail(path, fmt::format("point {} has a coordinate {}", i + 1, x));
        }
    }
    return sources;
}

}  // namespace controlspace

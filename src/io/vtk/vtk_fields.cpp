#include "io/vtk/vtk_fields.h"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkNew.h>

#include <initializer_list>

#include "controlspace/error.h"
#include "controlspace/sources/riemannian.h"
#include "io/text/output_file.h"

namespace controlspace {
namespace {

vtkDoubleArray& add_array(vtkFieldData& data, const char* name, int components,
                          std::size_t tuples) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
    data.AddArray(array);
    return *array;
}

}  // namespace

void add_metric_arrays(vtkFieldData& data, std::span<const Metric> metrics) {
    vtkDoubleArray& tensors = add_array(data, vtk_metric_array, 9, metrics.size());
    vtkDoubleArray& h_min = add_array(data, "h_min", 1, metrics.size());
    vtkDoubleArray& h_max = add_array(data, "h_max", 1, metrics.size());
    vtkDoubleArray& h_mean = add_array(data, "h_mean", 1, metrics.size());
    vtkDoubleArray& anisotropy = add_array(data, "anisotropy", 1, metrics.size());
    for (std::size_t k = 0; k < metrics.size(); ++k) {
        const auto i = static_cast<vtkIdType>(k);
        const Metric t = to_riemannian(metrics[k]);
        const double rows[] = {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz};
        tensors.SetTypedTuple(i, rows);
        const auto lengths = eigen_frame(metrics[k]).lengths;
        h_min.SetValue(i, lengths[0]);
        h_max.SetValue(i, lengths[2]);
        h_mean.SetValue(i, mean_length(metrics[k]));
        anisotropy.SetValue(i, lengths[2] / lengths[0]);
    }
}

void write_vtk_file(vtkXMLWriter& writer, vtkDataObject& data, const std::filesystem::path& path) {
    OutputFile file(path);
    // Whoever listens keeps VTK from printing its errors.
    vtkNew<vtkCallbackCommand> silence;
    writer.AddObserver(vtkCommand::ErrorEvent, silence);
    writer.GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence);
    writer.SetInputDataObject(&data);
    writer.SetFileName(file.written().c_str());
    if (writer.Write() != 1 || writer.GetErrorCode() != 0) {
        throw InputError(fmt::format("cannot write {}: VTK's error {} (is the disk full?)",
                                     path.string(), writer.GetErrorCode()));
    }
    file.commit();
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/fields/primitives.h"
#include "controlspace/geometry/box.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// Readers of file formats, provided by the program that links their libraries.
struct FileReaders {
    /// Receives remarks on what was read (ReadOptions); may be empty.
    std::function<void(const std::string&)> remark;
    /// Sources of kind `file`, by the ending of the file's name in small letters (".vdb"); of parts
    /// in the units of the field (FileSources), of others in those of the file.
    std::map<std::string, std::function<std::vector<PointSource>(const std::filesystem::path&,
                                                                 const SourcesChoice&)>>
        sources;
    /// A field of kind `file`; may be empty.
    std::function<AnalyticField(const FieldChoice&)> vdb_field;
    /// The distance from the surface in a file; may be empty.
    std::function<DistanceField(const std::filesystem::path&, const FileSources&)> surface_distance;
};

/// Sources and field, shared by all cases with the same ones.
struct Workload {
    SourceColumns sources;
    AnalyticField field;  ///< `field.field` is null where there is none
    Box domain;
    double finest_length = 0;  ///< smallest requested length, of sources and field
};

/// Whether any source is a tensor, or the continuous field may have tensors.
bool has_tensors(const Workload& workload);

/// The sources in the file of `choice` (of kind `file`), by the reader for its ending, or by
/// read_sources. Throws InputError.
std::vector<PointSource> read_source_file(const SourcesChoice& choice, const FileReaders& readers);

/// Samples or reads the sources, with lengths between h_min and h_max of `choice`. Without a domain
/// in the study, primitives define it only where there is nothing else. Throws InputError for a
/// source (named by its index, file and line) or a primitive outside the domain, and for a domain
/// beyond that of the field.
Workload make_workload(const Study& study, const SourcesChoice& choice,
                       const FileReaders& readers = {});

/// The options that the structure of case `c` is made with. Throws InputError where they are out
/// of range.
SpaceOptions space_options(const Study& study, const Case& c, const Workload& workload,
                           std::span<const CaseParameter> parameters = case_parameters());

/// Points at which structures are compared with their reference, and the reference there; and
/// places that depend on it at which their access is timed.
struct ReferenceProbes {
    Probes coarse;            ///< probe_grid^3 cell centres
    Probes fine;              ///< fine_probe_grid^3 cell centres
    std::vector<Point> near;  ///< near the sources; without, where the reference is fine
    std::vector<Point> walk;  ///< walks by half lengths of the reference, from near the sources
};

/// The reference of `c`, for δ_R and for exact values at control nodes. Depends only on the
/// sources, the kind of reference and g_r of `c`, and on the study's reference_tolerance.
std::shared_ptr<const ControlSpace> make_reference(const Study& study, const Case& c,
                                                   const Workload& workload);

/// The same at the probes.
ReferenceProbes make_reference_probes(const Study& study, const Case& c, const Workload& workload);

}  // namespace controlspace

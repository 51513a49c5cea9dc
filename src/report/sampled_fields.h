#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/catalogue.h"
#include "study/file_readers.h"
#include "study/row.h"
#include "study/study.h"

namespace controlspace {

/// Cells along each side of a slice.
constexpr int slice_cells = 200;

/// Rows that take longer to make are not made again for a picture.
constexpr double longest_creation_s = 60;

/// What one structure answers on a slice and at the probes of δ_R.
struct FieldSample {
    const Row* row = nullptr;    ///< null for the exact field
    std::vector<Metric> slice;   ///< slice_cells^2, x fastest
    std::vector<Metric> probes;  ///< probe_grid^3, x fastest
    /// The elements that the slice passes through; none where they are too many to be seen.
    std::optional<std::vector<Box>> elements;
};

/// Fields of structures that were made anew, and the exact one, over the same domain.
struct SampledFields {
    Box domain;
    double z = 0;  ///< height of the slice: the middle of the domain
    FieldSample exact;
    std::vector<FieldSample> structures;
    std::vector<std::string> left_out;  ///< "K_L s_L: why"
};

/// The first setting of `rows` that has measures: its first row for each structure.
std::vector<const Row*> first_setting(std::span<const Row> rows);

/// Makes the structures of `rows`, which share a setting, as `study` did, one after the other.
/// Throws InputError where the sources cannot be had again, or if there are no rows.
SampledFields sample_fields(const Study& study, std::span<const Row* const> rows,
                            std::span<const CatalogueEntry> catalogue, const FileReaders& readers);

/// The elements of `space` that the plane at height `z` passes through, by rising y; none if they
/// are more than `most`.
std::optional<std::vector<Box>> elements_on_slice(const ControlSpace& space, double z,
                                                  std::size_t most);

}  // namespace controlspace

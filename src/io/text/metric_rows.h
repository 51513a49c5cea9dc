// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// How a format stores a symmetric tensor: what it means, and the order of its components.
struct TensorLayout {
    bool riemannian;                     ///< M^-2, as other programs have it; else lengths M
    std::size_t numbers;                 ///< 6, or 9 for a whole matrix by rows
    std::array<std::size_t, 6> indices;  ///< of xx yy zz xy xz yz among the numbers
    std::string_view order;              ///< for messages
};
/// Medit and libMeshb: the lower triangle by rows.
inline constexpr TensorLayout medit_tensor{true, 6, {0, 2, 5, 1, 3, 4}, "xx xy yy xz yz zz"};
inline constexpr TensorLayout vtk_tensor{true, 6, {0, 1, 2, 3, 5, 4}, "XX YY ZZ XY YZ XZ"};
/// Gmsh, MMG's and our .vtu.
inline constexpr TensorLayout matrix_rows{true, 9, {0, 4, 8, 1, 2, 5}, "by rows"};
/// Tables with named columns.
inline constexpr TensorLayout length_tensor{false, 6, {0, 1, 2, 3, 4, 5}, "xx yy zz xy xz yz"};

/// The numbers of `m`, or of M^-2, as `layout` says: the first `layout.numbers` of the result.
std::array<double, 9> numbers_of(const Metric& m, const TensorLayout& layout);

/// Completes the message about a number for which is_length is false.
inline constexpr std::string_view length_rule = "a length must be positive, from 1e-50 to 1e+50";

/// The same about a number for which is_source_growth is false.
inline constexpr std::string_view growth_rule =
    "give the gradation ratio of the source, from 1 to 1e6, or 0 for the field's";

/// Thrown where tensors of a file are not positive definite, and nothing else about it is wrong.
class IndefiniteTensors : public InputError {
public:
    IndefiniteTensors(const std::string& what, std::vector<Metric> definite,
                      std::vector<std::size_t> indefinite)
        : InputError(what),
          definite_(std::make_shared<std::vector<Metric>>(std::move(definite))),
          indefinite_(std::make_shared<std::vector<std::size_t>>(std::move(indefinite))) {}

    /// Metrics of the other sources.
    const std::vector<Metric>& definite() const { return *definite_; }
    /// Numbers of the sources that are not positive definite, from 1 and ascending.
    const std::vector<std::size_t>& indefinite() const { return *indefinite_; }

private:
    // Shared, so that a copy of the exception does not throw.
    std::shared_ptr<const std::vector<Metric>> definite_;
    std::shared_ptr<const std::vector<std::size_t>> indefinite_;
};

/// The metrics of a file, row by row: sizes (one number) or tensors (6 or 9). This is the only
/// place where numbers of files become metrics. Tensors that are not positive definite are counted,
/// because their share tells whether the order of the components is right: read in a wrong order,
/// nine of ten are not.
class MetricRows {
public:
    /// `where` answers the place of the row that is being added, "name:line", for messages.
    MetricRows(std::function<std::string()> where, const TensorLayout& layout)
        : where_(std::move(where)), layout_(layout) {}

    /// Throws InputError for a size that is no length, and for a matrix that is not symmetric to
    /// 1e-6 of its largest entry.
    void add(std::span<const double> numbers);

    /// The metrics of all rows. Throws IndefiniteTensors, with the place of the first one.
    std::vector<Metric> take();

private:
    std::size_t count() const { return metrics_.size() + indefinite_.size(); }

    std::function<std::string()> where_;
    TensorLayout layout_;
    std::vector<Metric> metrics_;
    std::vector<std::size_t> indefinite_;
    std::string first_indefinite_;
};

/// Throws InputError "where(): `what` `number` ..." unless all coordinates are usable.
void require_coordinates(const Point& x, std::string_view what, std::size_t number,
                         const std::function<std::string()>& where);

/// Both have the same size.
std::vector<PointSource> sources_from(std::span<const Point> positions,
                                      std::span<const Metric> metrics);

/// Of sources with the same place and metric only the first is kept.
void drop_repeated(std::vector<PointSource>& sources);

}  // namespace controlspace

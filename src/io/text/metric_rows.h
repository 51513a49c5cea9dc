#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// What is said of a number that is no length (is_length).
constexpr std::string_view length_rule = "a length must be positive, from 1e-50 to 1e+50";

/// Takes the rows of another program's field, one after the other: sizes, or Riemannian metrics.
/// Tensors that are not positive definite are counted, since their share tells whether the order of
/// the components is right: read in a wrong order, nine of ten are not.
class MetricRows {
public:
    /// `order` is how the file is taken to order components, for the message: "xx xy yy xz yz zz".
    MetricRows(const std::filesystem::path& path, std::string_view order)
        : path_(path), order_(order) {}

    /// Throws InputError where `h` is no length.
    void add_size(double h);
    void add_tensor(const Metric& riemannian);
    /// A whole matrix, by rows. Throws InputError where it is not symmetric, to 1e-6 of its largest
    /// entry.
    void add_matrix(const std::array<double, 9>& riemannian);

    /// Metrics of all rows. Throws IndefiniteTensors that names the first tensor that is not
    /// positive definite, and says how many are not.
    std::vector<Metric> take();

private:
    std::filesystem::path path_;
    std::string order_;
    std::vector<Metric> metrics_;
    std::vector<std::size_t> indefinite_;  ///< their numbers, from 1
};

}  // namespace controlspace

#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "controlspace/geometry/point.h"

class GModel;
class GRegion;

namespace controlspace {

/// A size field of Gmsh in a model of its own, asked as Gmsh's mesher asks its background field.
/// Gmsh is one for the whole process and knows no threads: all fields share one lock. It stays open
/// until the process ends.
class GmshField {
public:
    struct Made {
        int field;      ///< its tag
        int view = -1;  ///< the view that it reads, if any
    };
    /// `make` adds the field to an empty model. It is asked once, at `x`, which builds its search:
    /// for a tensor if it `has_tensors`. Throws InputError for what Gmsh throws.
    GmshField(const std::function<Made()>& make, const Point& x, bool has_tensors = false);
    ~GmshField();
    GmshField(const GmshField&) = delete;
    GmshField& operator=(const GmshField&) = delete;

    /// What Gmsh's mesher gets for each place. Throws InputError for a place that the field does
    /// not cover.
    void sizes(std::span<const Point> x, std::span<double> out) const;
    /// The view's tensors, row by row, from the search that the field does. The mesher's own
    /// question for them (BGM_MeshMetric) turns tensors that are not symmetric to an axis,
    /// in 4.8.4.
    using Tensor = std::array<double, 9>;
    void tensors(std::span<const Point> x, std::span<Tensor> out) const;

    /// Allocated while it was made, as the allocator counts.
    std::size_t bytes() const { return bytes_; }

private:
    void require_open() const;

    std::string name_;
    Made made_{};
    GModel* model_ = nullptr;
    GRegion* region_ = nullptr;
    std::size_t bytes_ = 0;
};

}  // namespace controlspace

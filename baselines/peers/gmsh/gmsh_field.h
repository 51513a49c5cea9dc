#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "controlspace/geometry/point.h"

class Field;
class GModel;

namespace controlspace {

/// Opens Gmsh, which takes some tenths of a second, if it is not open yet.
void open_gmsh();

/// A size field of Gmsh in a model of its own, evaluated as Gmsh's mesher evaluates its background
/// field. Gmsh is one for the whole process and knows no threads: all fields share one lock. It
/// stays open until the process ends.
///
/// Tensors come from the field alone, too: what the mesher asks for them, BGM_MeshMetric of Gmsh
/// 4.8.4, takes 20 times as long and turns those whose directions are not the axes'.
class GmshField {
public:
    struct Made {
        int field = -1;  ///< its tag
        int view = -1;  ///< of a field PostView, the view that it reads; otherwise it is Structured
    };
    /// `make` adds the field to an empty model, and its view to what is removed in the end. It is
    /// asked once, at `x`, which builds its search: for a tensor if it `has_tensors`. Throws
    /// InputError for what Gmsh throws.
    GmshField(const std::function<void(Made&)>& make, const Point& x, bool has_tensors = false);
    ~GmshField();
    GmshField(const GmshField&) = delete;
    GmshField& operator=(const GmshField&) = delete;

    /// Throws InputError for a place that the field does not cover.
    void sizes(std::span<const Point> x, std::span<double> out) const;
    /// Of a PostView: xx, xy, yy, xz, yz, zz; zeros where it does not cover the place.
    using Tensor = std::array<double, 6>;
    void tensors(std::span<const Point> x, std::span<Tensor> out) const;

    /// Allocated while it was made, as the allocator counts.
    std::size_t bytes() const { return bytes_ > 0 ? static_cast<std::size_t>(bytes_) : 0; }

private:
    void ask_once(const Point& x, bool has_tensors);
    void remove() noexcept;
    void require_open() const;

    std::string name_;
    Made made_{};
    GModel* model_ = nullptr;
    Field* field_ = nullptr;
    std::ptrdiff_t bytes_ = 0;
};

}  // namespace controlspace

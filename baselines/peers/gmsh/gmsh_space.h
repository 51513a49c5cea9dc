// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"
#include "space/saved.h"

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
class GmshSpace final : public ControlSpace, public Saved {
public:
    struct Made {
        int field = -1;            ///< its tag
        int view = -1;             ///< that a field PostView reads; otherwise it is Structured
        bool has_tensors = false;  ///< of a view, M^-2
    };
    /// `make` adds the field, and its view, to an empty model. It is asked once, which builds its
    /// search. `counts`: of the footprint, without the bytes around the payload, which are those
    /// allocated meanwhile. Throws InputError for what Gmsh throws.
    GmshSpace(const Box& domain, const Footprint& counts, const std::function<Made()>& make);
    ~GmshSpace() override;

    /// Throw InputError for a place that the field does not cover.
    void sample(std::span<const Point> x, std::span<Metric> out) const override;
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override;
    Box domain() const override { return domain_; }
    Footprint footprint() const override { return footprint_; }
    void save(StateWriter&) const override;

private:
    void for_each_inside(std::span<const Point> x, const auto& answer) const;
    void remove() noexcept;

    Box domain_;
    Footprint footprint_;
    Made made_{};
    GModel* model_ = nullptr;
    Field* field_ = nullptr;
};

CatalogueEntry gmsh_view_row();
CatalogueEntry gmsh_structured_row();

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/lattice/lattice_data.h"
#include "baselines/lattice/stencil.h"
#include "controlspace/metric/stored_metrics.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "space/saved.h"
#include "space/shared_builder.h"

namespace controlspace {

/// A finished grid whose metrics a `Storage` holds:
///
///   Stored          what it answers for a node: Metric, StoredMetric, or StoredLength
///   Storage(const std::shared_ptr<const LatticeData>&)   in parallel
///   bytes_for, and, if it does not keep all bits, stored: see GridKind
///   reader() -> r   for one thread: r(i, j, k) -> Stored, and what Stencil::sample requests
///   void add_to(Footprint&) const           its bytes
template <class Storage, Interpolation interpolation>
class GridSpace final : public ControlSpace, public HasControlNodes, public Saved {
    static constexpr bool are_lengths = is_stored_length<typename Storage::Stored>;

public:
    explicit GridSpace(const std::shared_ptr<const LatticeData>& data)
        : stencil_(data->domain(), data->cells()),
          storage_(data),
          remark_(data->remark()),
          chosen_voxel_(data->chosen_voxel()) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        stencil_.template sample<Metric>(x, storage_.reader(), out);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (are_lengths) {
            stencil_.template sample<double>(x, storage_.reader(), out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override {
        return stencil_.template at<Metric>(x, storage_.reader());
    }
    double length_at(const Point& x) const override {
        if constexpr (are_lengths) {
            return stencil_.template at<double>(x, storage_.reader());
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override { return std::make_unique<GridCursor>(*this); }
    Box domain() const override { return stencil_.domain(); }
    std::optional<Box> cell_at(const Point& x) const override { return stencil_.cell_at(x); }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.cells = static_cast<std::size_t>(stencil_.cells().prod());
        footprint.control_nodes = stencil_.lattice().size();
        footprint.remark = remark_;
        storage_.add_to(footprint);
        footprint.bytes_auxiliary += given().bytes();
        return footprint;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        Lattice lattice = stencil_.lattice();
        lattice.neighbourhood = neighbourhood;
        return {lattice, metrics()};
    }
    void save(StateWriter& state) const override { save_lattice(metrics(), chosen_voxel_, state); }

private:
    /// Keeps one reader, which may remember nodes of a tree.
    class GridCursor final : public Cursor {
    public:
        explicit GridCursor(const GridSpace& grid)
            : stencil_(grid.stencil_), reader_(grid.storage_.reader()) {}

        Metric metric_at(const Point& x) override {
            return stencil_.template at<Metric>(x, reader_);
        }
        double length_at(const Point& x) override {
            if constexpr (are_lengths) {
                return stencil_.template at<double>(x, reader_);
            } else {
                return Cursor::length_at(x);
            }
        }

    private:
        const Stencil<interpolation>& stencil_;
        const decltype(std::declval<const Storage&>().reader()) reader_;
    };

    std::vector<Metric> metrics() const {
        const auto& read = storage_.reader();
        const auto [nx, ny, nz] = stencil_.lattice().nodes;
        std::vector<Metric> metrics;
        metrics.reserve(stencil_.lattice().size());
        for (std::uint32_t k = 0; k < nz; ++k) {
            for (std::uint32_t j = 0; j < ny; ++j) {
                for (std::uint32_t i = 0; i < nx; ++i) metrics.push_back(read(i, j, k));
            }
        }
        return metrics;
    }

    Stencil<interpolation> stencil_;
    Storage storage_;
    std::string remark_;
    double chosen_voxel_;
};

/// A grid in each precision: `Storage<M>` for what metrics are stored as, `Storage<Metric>` as its
/// builder holds it.
template <template <class> class Storage>
struct AnyPrecision {
    static double bytes_for(const Vector& nodes) { return Storage<Metric>::bytes_for(nodes); }
    static constexpr Metric (*stored)(const Metric&) = nullptr;

    template <Interpolation interpolation>
    static std::unique_ptr<ControlSpace> finish(const std::shared_ptr<const LatticeData>& data,
                                                std::optional<Precision> precision) {
        if (!precision) return std::make_unique<GridSpace<Storage<Metric>, interpolation>>(data);
        return with_stored<true>(
            *precision, data->field(),
            [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
                return std::make_unique<GridSpace<Storage<OrMetric<M>>, interpolation>>(data);
            });
    }
};

/// A grid in one precision, that of its system; of lengths in `Lengths` where all are isotropic.
template <class Storage, class Lengths = Storage>
struct OwnPrecision {
    static double bytes_for(const Vector& nodes) { return Storage::bytes_for(nodes); }
    static constexpr Metric (*stored)(const Metric&) = Storage::stored;

    template <Interpolation interpolation>
    static std::unique_ptr<ControlSpace> finish(const std::shared_ptr<const LatticeData>& data,
                                                std::optional<Precision> precision) {
        if (precision) refuse_precision();
        if (!std::is_same_v<Storage, Lengths> && std::ranges::all_of(data->field(), is_isotropic)) {
            return std::make_unique<GridSpace<Lengths, interpolation>>(data);
        }
        return std::make_unique<GridSpace<Storage, interpolation>>(data);
    }
};

/// `Forms`: AnyPrecision or OwnPrecision of a storage.
template <class Forms, Interpolation interpolation>
std::unique_ptr<ControlSpaceBuilder> make_grid(const SpaceOptions& options) {
    const GridKind kind{.interpolation = interpolation,
                        .bytes_for = Forms::bytes_for,
                        .finish = Forms::template finish<interpolation>,
                        .stored = Forms::stored};
    return std::make_unique<SharedBuilder<LatticeData>>(options, kind);
}
template <class Forms>
std::unique_ptr<ControlSpaceBuilder> make_grid(const SpaceOptions& options,
                                               Interpolation interpolation) {
    return interpolation == Interpolation::nearest
               ? make_grid<Forms, Interpolation::nearest>(options)
               : make_grid<Forms, Interpolation::trilinear>(options);
}

}  // namespace controlspace

#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "baselines/lattice/lattice_data.h"
#include "baselines/lattice/stencil.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/detail/shared_builder.h"

namespace controlspace {

/// A finished grid whose metrics a `Storage` holds:
///
///   Storage(const std::shared_ptr<const LatticeData>&)   in parallel
///   shares_field    whether it keeps the array of the data, which are a copy otherwise
///   bytes_for, and, if it does not keep all bits, stored: see GridKind
///   reader() -> r   for one thread: r(i, j, k) -> const Metric& or Metric, and what
///   Stencil::sample
///                   requests
///   void add_to(Footprint&) const           its bytes
template <class Storage, Interpolation interpolation>
class GridSpace final : public ControlSpace, public HasControlNodes, public Saved {
public:
    explicit GridSpace(std::shared_ptr<const LatticeData> data)
        : stencil_(data->domain(), data->cells()), storage_(data), remark_(data->remark()) {
        if (data->options().takes_later_sources) later_ = std::move(data);
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        stencil_.sample(x, storage_.reader(), out);
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
        if (given()) footprint.bytes_auxiliary += given()->bytes();
        if (!later_) return footprint;
        footprint.bytes_auxiliary += later_->later().requested.capacity() * sizeof(Metric);
        if (!Storage::shares_field) {
            footprint.bytes_auxiliary += later_->field().capacity() * sizeof(Metric);
        }
        return footprint;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        Lattice lattice = stencil_.lattice();
        lattice.neighbourhood = neighbourhood;
        return {lattice, metrics()};
    }
    void save(StateWriter& state) const override {
        save_lattice(metrics(), later_ ? later_->later() : LaterSources(), state);
    }

private:
    /// Keeps one reader, which may remember nodes of a tree.
    class GridCursor final : public Cursor {
    public:
        explicit GridCursor(const GridSpace& grid)
            : stencil_(grid.stencil_), reader_(grid.storage_.reader()) {}

        Metric metric_at(const Point& x) override {
            Metric m;
            stencil_.sample({&x, 1}, reader_, {&m, 1});
            return m;
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
    std::shared_ptr<const LatticeData> later_;  // where sources may come later
};

template <class Storage, Interpolation interpolation>
std::unique_ptr<ControlSpaceBuilder> make_grid(const SpaceOptions& options) {
    GridKind kind{
        .interpolation = interpolation,
        .bytes_for = Storage::bytes_for,
        .finish =
            [](const std::shared_ptr<const LatticeData>& data) -> std::unique_ptr<ControlSpace> {
            return std::make_unique<GridSpace<Storage, interpolation>>(data);
        }};
    if constexpr (requires { &Storage::stored; }) kind.stored = Storage::stored;
    return std::make_unique<SharedBuilder<LatticeData>>(options, kind);
}
template <class Storage>
std::unique_ptr<ControlSpaceBuilder> make_grid(const SpaceOptions& options,
                                               Interpolation interpolation) {
    return interpolation == Interpolation::nearest
               ? make_grid<Storage, Interpolation::nearest>(options)
               : make_grid<Storage, Interpolation::trilinear>(options);
}

}  // namespace controlspace

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/grid_space.h"
#include "baselines/rows.h"

namespace controlspace {

namespace {

/// Metrics in one array, x fastest: that of the builder.
class FlatArray {
public:
    static constexpr bool shares_field = true;

    explicit FlatArray(std::shared_ptr<const LatticeData> data)
        : data_(std::move(data)), first_(data_->field().data()) {
        const auto [nx, ny, nz] = data_->lattice().nodes;
        row_ = nx;
        layer_ = row_ * ny;
        // In a flat domain the one layer is the high side of the cells too.
        to_high_ = {nx > 1 ? 1 : std::size_t{0}, ny > 1 ? row_ : 0, nz > 1 ? layer_ : 0};
    }

    static double bytes_for(const Vector& nodes) { return nodes.prod() * sizeof(Metric); }

    const FlatArray& reader() const { return *this; }

    const Metric& operator()(std::size_t i, std::size_t j, std::size_t k) const {
        return first_[k * layer_ + j * row_ + i];
    }
    const Metric* prepare(const Cell& cell) const {
        return &(*this)(static_cast<std::size_t>(cell[0]), static_cast<std::size_t>(cell[1]),
                        static_cast<std::size_t>(cell[2]));
    }
    template <std::size_t corners>
    const Metric* find(const Cell&, const Metric* low) const {
        for (std::size_t corner = 0; corner < corners; ++corner) prefetch(&metric(low, corner));
        return low;
    }
    const Metric& metric(const Metric* low, std::size_t corner) const {
        return low[(corner & 1) * to_high_[0] + (corner >> 1 & 1) * to_high_[1] +
                   (corner >> 2) * to_high_[2]];
    }

    void add_to(Footprint& footprint) const {
        footprint.bytes_payload += data_->field().capacity() * sizeof(Metric);
    }

private:
    std::size_t row_, layer_;
    std::array<std::size_t, 3> to_high_;  // from a node to the next one along each axis
    std::shared_ptr<const LatticeData> data_;
    const Metric* first_;
};

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    return make_grid<FlatArray>(options, interpolation);
}

}  // namespace

std::vector<CatalogueEntry> uniform_rows() {
    return {grid_row<make, Interpolation::nearest>("uniform-nearest",
                                                   "uniform grid, a metric per cell, constant"),
            grid_row<make, Interpolation::trilinear>(
                "uniform-trilinear", "uniform grid, a metric per vertex, trilinear")};
}

}  // namespace controlspace

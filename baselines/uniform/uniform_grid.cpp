#include "baselines/uniform/uniform_grid.h"

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/grid_space.h"

namespace controlspace {

namespace {

/// Metrics in one array, x fastest: that of the builder.
class FlatArray {
public:
    static constexpr bool shares_field = true;

    explicit FlatArray(std::shared_ptr<const LatticeData> data)
        : row_(data->lattice().nodes[0]),
          layer_(row_ * data->lattice().nodes[1]),
          data_(std::move(data)),
          first_(data_->field().data()) {}

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
        return low[(corner & 1) + (corner >> 1 & 1) * row_ + (corner >> 2) * layer_];
    }

    void add_to(Footprint& footprint) const {
        footprint.bytes_payload += data_->field().capacity() * sizeof(Metric);
    }

private:
    std::size_t row_, layer_;
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

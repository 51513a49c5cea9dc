#include "baselines/uniform/uniform_grid.h"

#include <vector>

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/lattice_space.h"

namespace controlspace {

namespace {

class FlatArray {
public:
    FlatArray(const Lattice& lattice, const Metric& initial)
        : row_(lattice.nodes[0]),
          layer_(row_ * lattice.nodes[1]),
          metrics_(lattice.size(), initial) {}

    static double bytes_for(const Vector& nodes) { return nodes.prod() * sizeof(Metric); }

    auto reader() const {
        return [this](std::size_t i, std::size_t j, std::size_t k) -> const Metric& {
            return metrics_[index(i, j, k)];
        };
    }

    auto writer() {
        struct Writer {
            FlatArray& array;
            const Metric& get(std::size_t i, std::size_t j, std::size_t k) const {
                return array.metrics_[array.index(i, j, k)];
            }
            void set(std::size_t i, std::size_t j, std::size_t k, const Metric& m) {
                array.metrics_[array.index(i, j, k)] = m;
            }
        };
        return Writer{*this};
    }

    void add_to(Footprint& footprint) const {
        footprint.bytes_payload += metrics_.capacity() * sizeof(Metric);
    }

private:
    std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
        return k * layer_ + j * row_ + i;
    }

    std::size_t row_;
    std::size_t layer_;
    std::vector<Metric> metrics_;
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_uniform_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return make_lattice_space<FlatArray>(options, interpolation);
}

std::vector<CatalogueEntry> uniform_rows() {
    return {grid_row<make_uniform_grid, Interpolation::nearest>(
                "uniform-nearest", "uniform grid, a metric per cell, constant"),
            grid_row<make_uniform_grid, Interpolation::trilinear>(
                "uniform-trilinear", "uniform grid, a metric per vertex, trilinear")};
}

}  // namespace controlspace

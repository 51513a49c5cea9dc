// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/grid_space.h"
#include "baselines/rows.h"

namespace controlspace {

namespace {

/// Metrics in one array, x fastest: with Metric that of the builder.
template <class M>
class FlatArray {
public:
    using Stored = M;
    static constexpr bool shares_field = std::is_same_v<M, Metric>;

    explicit FlatArray(const std::shared_ptr<const LatticeData>& data) : kept_(kept(data)) {
        const auto [nx, ny, nz] = data->lattice().nodes;
        row_ = nx;
        layer_ = row_ * ny;
        // In a flat domain the one layer is the high side of the cells too.
        to_high_ = {nx > 1 ? 1 : std::size_t{0}, ny > 1 ? row_ : 0, nz > 1 ? layer_ : 0};
    }

    static double bytes_for(const Vector& nodes) { return nodes.prod() * sizeof(Metric); }

    class Reader {
    public:
        using Item = typename Packing<M>::Item;

        explicit Reader(const FlatArray& array) : array_(array), first_(array.items()) {
            if constexpr (!shares_field) packing_ = array.kept_.packing();
        }
        decltype(auto) operator()(std::size_t i, std::size_t j, std::size_t k) const {
            return packing_(*item(i, j, k));
        }
        const Item* prepare(const Cell& cell) const {
            return item(static_cast<std::size_t>(cell[0]), static_cast<std::size_t>(cell[1]),
                        static_cast<std::size_t>(cell[2]));
        }
        template <std::size_t corners, bool ahead = true>
        const Item* find(const Cell&, const Item* low) const {
            for (std::size_t corner = 0; ahead && corner < corners; ++corner) {
                prefetch(at(low, corner));
            }
            return low;
        }
        decltype(auto) metric(const Item* low, std::size_t corner) const {
            return packing_(*at(low, corner));
        }

    private:
        const Item* item(std::size_t i, std::size_t j, std::size_t k) const {
            return first_ + k * array_.layer_ + j * array_.row_ + i;
        }
        const Item* at(const Item* low, std::size_t corner) const {
            const auto& to_high = array_.to_high_;
            return low + (corner & 1) * to_high[0] + (corner >> 1 & 1) * to_high[1] +
                   (corner >> 2) * to_high[2];
        }

        const FlatArray& array_;
        const Item* first_;
        Packing<M> packing_;
    };
    Reader reader() const { return Reader(*this); }

    void add_to(Footprint& footprint) const {
        if constexpr (shares_field) {
            footprint.bytes_payload += kept_->field().capacity() * sizeof(Metric);
        } else {
            footprint.bytes_payload += kept_.bytes();
        }
    }

private:
    using Kept =
        std::conditional_t<shares_field, std::shared_ptr<const LatticeData>, StoredMetrics<M>>;

    static Kept kept(const std::shared_ptr<const LatticeData>& data) {
        if constexpr (shares_field) {
            return data;
        } else {
            return StoredMetrics<M>(data->field());
        }
    }
    const auto* items() const {
        if constexpr (shares_field) {
            return kept_->field().data();
        } else {
            return kept_.items().data();
        }
    }

    std::size_t row_, layer_;
    std::array<std::size_t, 3> to_high_;  // from a node to the next one along each axis
    Kept kept_;
};

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    return make_grid<AnyPrecision<FlatArray>>(options, interpolation);
}

}  // namespace

std::vector<CatalogueEntry> uniform_rows() {
    return {grid_row<make, Interpolation::nearest>("uniform-nearest",
                                                   "uniform grid, a value per cell, constant"),
            grid_row<make, Interpolation::trilinear>(
                "uniform-trilinear", "uniform grid, a value per vertex, trilinear")};
}

}  // namespace controlspace

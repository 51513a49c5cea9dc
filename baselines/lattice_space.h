#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "baselines/stencil.h"
#include "baselines/voxels.h"
#include "metric/intersection.h"
#include "spaces/catalogue.h"
#include "spaces/control_space.h"

namespace controlspace {

/// A control space on a regular lattice of nodes: all that does not depend on how their metrics
/// are stored. The contract of a `Storage`:
///
///   Storage(const Lattice& lattice, const Metric& initial)
///   static double bytes_for(const Vector& nodes)  what a storage of so many nodes will allocate
///   reader()  -> r with r(i, j, k) -> const Metric&; cheap, one per call of `sample`
///   writer()  -> w with w.get(i, j, k) -> const Metric& and w.set(i, j, k, metric)
///   void add_to(Footprint&) const                 its bytes
///
/// For `Stencil` see baselines/stencil.h.
template <class Storage, class Stencil>
class LatticeSpace final : public ControlSpace {
public:
    /// Cells as fine as the options ask and allow. Throws InputError as choose_voxels does.
    explicit LatticeSpace(const SpaceOptions& options)
        : LatticeSpace(options,
                       choose_voxels(options, Stencil::interpolation, Storage::bytes_for)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        assert(x.size() == out.size());
        const auto read = storage_.reader();
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = stencil_.value(x[i], read);
    }

    Insertion insert(const PointSource& source) override {
        require_valid(source, 0, domain());
        auto nodes = storage_.writer();
        return insert_through(nodes, source);
    }

    InsertionReport insert(std::span<const PointSource> sources) override {
        auto nodes = storage_.writer();
        InsertionReport report;
        for (std::size_t i = 0; i < sources.size(); ++i) {
            require_valid(sources[i], i, domain());
            ++report.sources;
            if (insert_through(nodes, sources[i]) == Insertion::inserted) ++report.inserted;
        }
        return report;
    }

    ControlNodes control_nodes(Neighbourhood) const override {
        const Lattice lattice = stencil_.lattice();
        const auto read = storage_.reader();
        std::vector<Metric> metrics;
        metrics.reserve(lattice.size());
        for_each_node(lattice, [&](auto i, auto j, auto k) { metrics.push_back(read(i, j, k)); });
        return {lattice, std::move(metrics)};
    }

    void assign(std::span<const Metric> metrics) override {
        const Lattice lattice = stencil_.lattice();
        if (metrics.size() != lattice.size()) {
            throw std::invalid_argument("assign() takes one metric for each control node");
        }
        auto nodes = storage_.writer();
        auto next = metrics.begin();
        for_each_node(lattice, [&](auto i, auto j, auto k) { nodes.set(i, j, k, *next++); });
    }

    const Box& domain() const override { return stencil_.domain(); }
    Box element_at(const Point& x) const override { return stencil_.cell_at(x); }

    Footprint footprint() const override {
        Footprint footprint;
        footprint.elements = static_cast<std::size_t>(stencil_.cells().prod());
        footprint.control_nodes = stencil_.lattice().size();
        footprint.depth = 1;
        footprint.remark = remark_;
        storage_.add_to(footprint);
        return footprint;
    }

private:
    LatticeSpace(const SpaceOptions& options, Voxels voxels)
        : tolerance_(options.tolerance),
          stencil_(options.domain, voxels.cells),
          storage_(stencil_.lattice(), Metric::isotropic(options.domain.half_diagonal())),
          remark_(std::move(voxels.remark)) {}

    template <class Writer>
    Insertion insert_through(Writer& nodes, const PointSource& source) {
        const Metric held = stencil_.value(
            source.position,
            [&](auto i, auto j, auto k) -> const Metric& { return nodes.get(i, j, k); });
        if (!calls_for_change(source.metric, held, tolerance_)) return Insertion::already_met;
        stencil_.for_each_node(source.position, [&](auto i, auto j, auto k) {
            nodes.set(i, j, k, intersection(nodes.get(i, j, k), source.metric));
        });
        return Insertion::inserted;
    }

    /// x fastest, as Lattice numbers them.
    template <class Visit>
    static void for_each_node(const Lattice& lattice, Visit&& visit) {
        for (std::uint32_t k = 0; k < lattice.nodes[2]; ++k) {
            for (std::uint32_t j = 0; j < lattice.nodes[1]; ++j) {
                for (std::uint32_t i = 0; i < lattice.nodes[0]; ++i) visit(i, j, k);
            }
        }
    }

    double tolerance_;
    Stencil stencil_;
    Storage storage_;
    std::string remark_;
};

template <class Storage>
std::unique_ptr<ControlSpace> make_lattice_space(const SpaceOptions& options,
                                                 Interpolation interpolation) {
    if (interpolation == Interpolation::nearest) {
        return std::make_unique<LatticeSpace<Storage, NearestStencil>>(options);
    }
    return std::make_unique<LatticeSpace<Storage, TrilinearStencil>>(options);
}

}  // namespace controlspace

#pragma once

#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// The nodes of a lattice as Regradation wants them: what sources ask for through a storage's
/// `Reader`, the field through a storage's `Writer` (see lattice_space.h).
template <class Reader, class Writer>
class LatticeNodes {
public:
    using Node = NodeIndex;

    LatticeNodes(const Lattice& lattice, Reader asked, Writer field)
        : lattice_(lattice), asked_(asked), field_(field) {}

    double asked(NodeIndex node) const {
        const auto [i, j, k] = lattice_.coordinates(node);
        return asked_(i, j, k).xx;
    }
    double field(NodeIndex node) const {
        const auto [i, j, k] = lattice_.coordinates(node);
        return field_.get(i, j, k).xx;
    }
    void set(NodeIndex node, double h) {
        const auto [i, j, k] = lattice_.coordinates(node);
        field_.set(i, j, k, Metric::isotropic(h));
    }
    template <class Visit>
    void for_each_link(NodeIndex node, Visit&& visit) const {
        lattice_.for_each_link(node, visit);
    }

private:
    Lattice lattice_;
    Reader asked_;
    Writer field_;
};

}  // namespace controlspace

#include "spaces/anchored_values.h"

#include "gradation/queue.h"
#include "metric/nonconformity.h"

namespace controlspace {

AnchoredValues::AnchoredValues(const SpaceOptions& options)
    : anchors_(1),
      largest_(largest_metric(options.domain)),
      ratio_(options.ratio),
      tolerance_(options.tolerance),
      l_min_(options.l_min) {}

void AnchoredValues::split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
    const Anchors inherited = anchors_[leaf];
    anchors_.insert(anchors_.end(), static_cast<std::size_t>(subdivision.children() - 1),
                    inherited);
}

void AnchoredValues::lower(const LeafPlace& place, const PointSource& source) {
    Anchors& anchors = anchors_[place.leaf];
    if (anchors.size() < Anchors::most) {
        anchors.add(sources_.add(source));
        return;
    }
    // How much coarser the leaf would be without an anchor, where the leaf is nearest to it.
    const auto loss_without = [&](std::size_t i) {
        const Point x =
            sources_.position(anchors[i]).cwiseMax(place.box.low).cwiseMin(place.box.high);
        const Metric with = cones().at(x, anchors.span());
        Metric without = intersection(largest_, source.metric);
        without = ConeIntersection<Metric>(sources_, ratio_, without)
                      .at(x, std::array{anchors[(i + 1) % 3], anchors[(i + 2) % 3]});
        return nonconformity(with, without);
    };
    std::size_t least = 0;
    double loss = loss_without(0);
    for (std::size_t i = 1; i < Anchors::most; ++i) {
        const double other = loss_without(i);
        if (other < loss) {
            loss = other;
            least = i;
        }
    }
    PointSource newcomer = source;
    if (loss >= tolerance_) {
        newcomer.metric = intersection(source.metric, sources_.metric(anchors[least]));
    }
    anchors[least] = sources_.add(newcomer);
}

template <class Size>
std::uint64_t AnchoredValues::spread(const ConeIntersection<Size>& field, const LeafGraph& leaves,
                                     std::span<const Box> boxes, NodeQueue queue,
                                     std::vector<NodeIndex>& badly_served) {
    std::vector<Size> at_centre;
    at_centre.reserve(leaves.order.size());
    for (std::size_t i = 0; i < leaves.order.size(); ++i) {
        at_centre.push_back(field.at(leaves.graph.positions[i], anchors_[leaves.order[i]].span()));
    }
    std::uint64_t gains = 0;
    std::vector<std::uint8_t> touched(leaves.order.size(), 0);  // it or a neighbour has had a turn
    while (!queue.empty()) {
        const NodeIndex i = queue.pop();
        touched[i] = 1;
        const Anchors offered = anchors_[leaves.order[i]];
        leaves.graph.for_each_neighbour(i, [&](NodeIndex j) {
            touched[j] = 1;
            Anchors& anchors = anchors_[leaves.order[j]];
            bool gained = false;
            for (const SourceIndex source : offered.span()) {
                if (anchors.contains(source)) continue;
                if (!field.may_matter(source, boxes[j], at_centre[j])) continue;
                const Anchors better = field.improved(anchors, source, boxes[j]);
                if (better == anchors) continue;
                anchors = better;
                at_centre[j] = field.at(leaves.graph.positions[j], anchors.span());
                gained = true;
            }
            if (!gained) return;
            ++gains;
            queue.push(j);
        });
    }
    for (NodeIndex i = 0; i < leaves.order.size(); ++i) {
        if (touched[i] != 0 && !is_well_served(field, leaves, i, boxes[i])) {
            badly_served.push_back(i);
        }
    }
    return gains;
}

template <class Size>
bool AnchoredValues::is_well_served(const ConeIntersection<Size>& field, const LeafGraph& leaves,
                                    NodeIndex node, const Box& box) const {
    if constexpr (std::is_same_v<Size, Metric>) return true;  // see anchors.cpp on tensors
    constexpr double unlike = 0.02;                           // non-conformity
    const Anchors& own = anchors_[leaves.order[node]];
    const Metric centre = as_metric(field.at(box.centre(), own.span()));
    const auto edges = metric_edge_lengths(centre, box.edges());
    if (std::max({edges[0], edges[1], edges[2]}) <= l_min_) return true;
    for (int c = 0; c < 8; ++c) {
        const Point x = corner(box, c);
        const Size here = field.at(x, own.span());
        Size best = here;
        leaves.graph.for_each_neighbour(node, [&](NodeIndex j) {
            for (const SourceIndex source : anchors_[leaves.order[j]].span()) {
                if (!own.contains(source)) best = intersection(best, field.cone(source, x));
            }
        });
        if (nonconformity(as_metric(here), as_metric(best)) > unlike) return false;
    }
    return true;
}

template std::uint64_t AnchoredValues::spread(const ConeIntersection<double>&, const LeafGraph&,
                                              std::span<const Box>, NodeQueue,
                                              std::vector<NodeIndex>&);
template std::uint64_t AnchoredValues::spread(const ConeIntersection<Metric>&, const LeafGraph&,
                                              std::span<const Box>, NodeQueue,
                                              std::vector<NodeIndex>&);

void AnchoredValues::drop_idle_sources() {
    std::vector<std::uint8_t> used(sources_.size(), 0);
    for (const Anchors& anchors : anchors_) {
        for (const SourceIndex source : anchors.span()) used[source] = 1;
    }
    const std::vector<SourceIndex> renamed = sources_.keep(used);
    for (Anchors& anchors : anchors_) {
        const std::size_t n = anchors.size();
        for (std::size_t i = 0; i < n; ++i) anchors[i] = renamed[anchors[i]];
    }
}

std::vector<Metric> AnchoredValues::metrics_at_centres(const LeafGraph& leaves) const {
    std::vector<Metric> metrics;
    metrics.reserve(leaves.order.size());
    for (std::size_t i = 0; i < leaves.order.size(); ++i) {
        metrics.push_back(cones().at(leaves.graph.positions[i], anchors_[leaves.order[i]].span()));
    }
    return metrics;
}

void AnchoredValues::describe(Footprint& footprint) const {
    footprint.control_nodes = anchors_.size();
    footprint.bytes_payload = anchors_.capacity() * sizeof(Anchors) + sources_.bytes();
}

void AnchoredValues::shrink_to_fit() {
    anchors_.shrink_to_fit();
    sources_.shrink_to_fit();
}

}  // namespace controlspace

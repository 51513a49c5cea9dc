// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/cell_model.h"

#include <algorithm>
#include <utility>

#include "trees/adaptation/cell_judge.h"
#include "trees/adaptation/nearby_field.h"
#include "trees/in_parallel.h"
#include "trees/make_room.h"
#include "trees/model_state.h"

namespace controlspace {

namespace {

class Describe final : public LeafArrays {
public:
    explicit Describe(Footprint& footprint) : footprint_(footprint) {}

private:
    void visit(std::string_view, LeafArray& array) override {
        footprint_.bytes_payload += array.capacity() * array.entry_size();
    }
    void visit(std::string_view, double&) override {}

    Footprint& footprint_;
};

class Shrink final : public LeafArrays {
private:
    void visit(std::string_view, LeafArray& array) override { array.shrink_to_fit(); }
    void visit(std::string_view, double&) override {}
};

}  // namespace

void CellModel::lower(const CellBox& cell, const Metric& metric) {
    if (corners().empty()) return metrics_.lower(cell.cell, metric);
    for (const NodeIndex node : corners()[cell.cell]) metrics_.lower(node, metric);
}

std::vector<Judgement> CellModel::fit(std::span<const CellBox> cells, const FieldToFit& to) {
    std::vector<std::pair<NodeIndex, Point>> nodes;
    if (corners().empty()) {
        nodes.reserve(cells.size());
        for (const CellBox& c : cells) nodes.emplace_back(c.cell, c.box.centre());
    } else {
        nodes.reserve(8 * cells.size());
        for (const CellBox& c : cells) {
            for (const NodeIndex node : corners()[c.cell]) {
                nodes.emplace_back(node, positions()[node]);
            }
        }
        const auto number = [](const auto& node) { return node.first; };
        std::ranges::sort(nodes, {}, number);
        const auto repeated = std::ranges::unique(nodes, {}, number);
        nodes.erase(repeated.begin(), repeated.end());
    }
    in_parallel(nodes.size(), [&, nearby = NearbyField(to.goal)](std::size_t i) mutable {
        metrics_.set(nodes[i].first, nearby.at(nodes[i].second));
    });
    return {};
}

Judgement CellModel::judge(const CellBox& cell, CellJudge& judge) const {
    return judge.by_samples(cell);
}

void CellModel::describe(Footprint& footprint) const {
    metrics_.describe(footprint);
    Describe describe(footprint);
    read_arrays(*this, describe);
}

void CellModel::shrink_to_fit() {
    metrics_.shrink_to_fit();
    Shrink shrink;
    arrays(shrink);
}

void for_each_cell(std::span<const CellBox> cells,
                   const std::function<void(const CellBox&)>& visit) {
    in_parallel(cells.size(), [&](std::size_t i) { visit(cells[i]); });
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "trees/model_state.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace controlspace {

namespace {

class Save final : public LeafArrays {
public:
    explicit Save(StateWriter& state) : state_(state) {}

private:
    void visit(std::string_view name, LeafArray& array) override {
        state_.append(name, array.kind(), array.entry_size(), array.data(), array.size());
    }
    void visit(std::string_view name, double& number) override { state_(name, number); }

    StateWriter& state_;
};

class Load final : public LeafArrays {
public:
    explicit Load(const StateReader& state) : state_(state) {}

private:
    void visit(std::string_view name, LeafArray& array) override {
        state_.read(
            name, array.kind(), array.entry_size(),
            [&](std::size_t entries) { array.clear(entries); },
            [&](const void* piece, std::size_t entries) { array.append(piece, entries); });
    }
    void visit(std::string_view name, double& number) override { state_(name, number); }

    const StateReader& state_;
};

class RequireSound final : public LeafArrays {
public:
    RequireSound(std::size_t leaves, const StateReader& state) : leaves_(leaves), state_(state) {}

private:
    void visit(std::string_view name, LeafArray& array) override {
        state_.require(array.size() == leaves_, name, "has another number of leaves");
        if (array.kind() != NumberKind::reals) return;
        const std::span numbers(static_cast<const double*>(array.data()),
                                array.size() * (array.entry_size() / sizeof(double)));
        state_.require(std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }),
                       name, "is not finite");
    }
    void visit(std::string_view, double&) override {}

    std::size_t leaves_;
    const StateReader& state_;
};

class Reorder final : public LeafArrays {
public:
    explicit Reorder(const std::vector<LeafIndex>& former) : former_(former) {}

private:
    void visit(std::string_view, LeafArray& array) override { array.reorder(former_); }
    void visit(std::string_view, double&) override {}

    const std::vector<LeafIndex>& former_;
};

}  // namespace

// One list of arrays serves what changes them and what does not.
void read_arrays(const CellModel& model, LeafArrays& visitor) {
    const_cast<CellModel&>(model).arrays(visitor);
}

void save_model(const CellModel& model, const NodeMetrics& metrics, StateWriter& state) {
    NodeMetrics::exchange(metrics, state);
    Save save(state);
    read_arrays(model, save);
}

template <class Node>
void load_model(LeafModel<Node>& model, const Topology<Node>& tree, const StateReader& state) {
    NodeMetrics::exchange(model.metrics(), state);
    Load load(state);
    model.arrays(load);
    model.loaded(tree, state);
}

void require_sound_arrays(const CellModel& model, std::size_t leaves, const StateReader& state) {
    RequireSound require(leaves, state);
    read_arrays(model, require);
}

void reorder_arrays(CellModel& model, const std::vector<LeafIndex>& former) {
    Reorder reorder(former);
    model.arrays(reorder);
}

template void load_model(LeafModel<KdNode>&, const Topology<KdNode>&, const StateReader&);
template void load_model(LeafModel<OctreeNode>&, const Topology<OctreeNode>&, const StateReader&);

}  // namespace controlspace

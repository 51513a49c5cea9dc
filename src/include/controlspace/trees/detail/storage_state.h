// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/space/detail/state.h"
#include "controlspace/trees/detail/make_room.h"
#include "controlspace/trees/storage.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// Calls visit(name, array) for the arrays among the data of a storage.
template <class Storage, class Visit>
void for_each_array(Storage& storage, Visit&& visit) {
    if constexpr (HasData<Storage>) {
        std::remove_const_t<Storage>::data(storage, [&](std::string_view name, auto& value) {
            if constexpr (requires { value.capacity(); }) visit(name, value);
        });
    }
}

/// Writes the metrics of all nodes and the data of a storage.
template <class Storage>
void save_storage(const Storage& storage, const NodeMetrics& metrics, StateWriter& state) {
    NodeMetrics::exchange(metrics, state);
    if constexpr (HasData<Storage>) Storage::data(storage, state);
}

/// Reads what save_storage has written for a tree. Throws InputError where it is not sound.
template <class Node, class Storage>
void load_storage(Storage& storage, const Topology<Node>& tree, const StateReader& state) {
    NodeMetrics::exchange(storage.metrics(), state);
    if constexpr (HasData<Storage>) Storage::data(storage, state);
    if constexpr (requires { storage.loaded(tree, state); }) {
        storage.loaded(tree, state);
    } else {
        storage.metrics().require_sound(state, tree.leaves());
        for_each_array(storage, [&]<class T>(std::string_view name, const std::vector<T>& array) {
            state.require(array.size() == tree.leaves(), name, "has another number of leaves");
            if constexpr (number_kind<T>() == NumberKind::reals) {
                const std::span numbers(reinterpret_cast<const double*>(array.data()),
                                        array.size() * (sizeof(T) / sizeof(double)));
                state.require(
                    std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }), name,
                    "is not finite");
            }
        });
    }
}

template <class Storage>
void describe_storage(const Storage& storage, Footprint& footprint) {
    if constexpr (requires { storage.describe(footprint); }) {
        storage.describe(footprint);
    } else {
        storage.metrics().describe(footprint);
        for_each_array(storage, [&](std::string_view, const auto& array) {
            footprint.bytes_payload += array.capacity() * sizeof(array[0]);
        });
    }
}

template <class Storage>
void shrink_storage(Storage& storage) {
    if constexpr (requires { storage.shrink_to_fit(); }) {
        storage.shrink_to_fit();
    } else {
        storage.metrics().shrink_to_fit();
        for_each_array(storage,
                       [](std::string_view, auto& array) { controlspace::shrink_to_fit(array); });
    }
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
// Saved control spaces whose size and checksum are right, whatever else is not. Inputs are changed
// array by array, behind the compression; where there is none yet, a file is made that is whole.
#define XXH_INLINE_ALL
#include <blosc.h>
#include <tbb/global_control.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <random>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "files/text_file.h"
#include "fuzz/fuzzing.h"
#include "fuzz/memory_file.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed);

using namespace controlspace;

namespace {

// control_space_file.h
constexpr std::size_t size_at = 16, header_size = 24, checksum_size = 8;

std::string repaired(std::string bytes) {
    if (bytes.size() < header_size + checksum_size) return bytes;
    const std::uint64_t size = bytes.size();
    std::memcpy(bytes.data() + size_at, &size, sizeof size);
    const std::uint64_t checksum = XXH3_64bits(bytes.data(), bytes.size() - checksum_size);
    std::memcpy(bytes.data() + bytes.size() - checksum_size, &checksum, sizeof checksum);
    return bytes;
}

/// An array as state.cpp has it, of one chunk.
struct Array {
    std::string name;
    std::uint32_t kind = 0, element_size = 1;
    std::string data;
};

std::optional<std::vector<Array>> unpacked(std::string_view bytes) {
    if (bytes.size() < header_size + checksum_size) return std::nullopt;
    bytes = bytes.substr(header_size, bytes.size() - header_size - checksum_size);
    const auto take = [&](auto& value) {
        if (bytes.size() < sizeof value) return false;
        std::memcpy(&value, bytes.data(), sizeof value);
        bytes.remove_prefix(sizeof value);
        return true;
    };
    std::vector<Array> arrays;
    while (!bytes.empty()) {
        Array& array = arrays.emplace_back();
        std::uint32_t name_size = 0, stored = 0;
        std::uint64_t elements = 0;
        if (!take(name_size) || bytes.size() < name_size) return std::nullopt;
        array.name = bytes.substr(0, name_size);
        bytes.remove_prefix(name_size);
        if (!take(array.kind) || !take(array.element_size) || array.element_size == 0 ||
            !take(elements)) {
            return std::nullopt;
        }
        if (elements == 0) continue;
        std::size_t size = 0;
        std::uint32_t block = 0;
        if (!take(stored) || bytes.size() < stored ||
            blosc_cbuffer_validate(bytes.data(), stored, &size) != 0 || size > 1 << 18) {
            return std::nullopt;
        }
        std::memcpy(&block, bytes.data() + 8, sizeof block);
        if (std::uint8_t(bytes[3]) != array.element_size || block == 0 || block > size) {
            return std::nullopt;  // as state.cpp
        }
        array.data.resize(size);
        if (blosc_decompress_ctx(bytes.data(), array.data.data(), size, 1) < 0) return std::nullopt;
        bytes.remove_prefix(stored);
    }
    return arrays;
}

std::string packed(std::string_view head, const std::vector<Array>& arrays) {
    std::string bytes(head.substr(0, header_size));
    const auto append = [&](auto value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const Array& array : arrays) {
        append(static_cast<std::uint32_t>(array.name.size()));
        bytes += array.name;
        append(array.kind);
        append(array.element_size);
        append(std::uint64_t{array.data.size() / array.element_size});
        if (array.data.empty()) continue;
        std::string chunk(array.data.size() + BLOSC_MAX_OVERHEAD, '\0');
        const int stored =
            blosc_compress_ctx(5, BLOSC_SHUFFLE, array.element_size, array.data.size(),
                               array.data.data(), chunk.data(), chunk.size(), "lz4", 0, 1);
        append(static_cast<std::uint32_t>(stored));
        bytes.append(chunk, 0, static_cast<std::size_t>(stored));
    }
    return repaired(bytes + std::string(checksum_size, '\0'));
}

/// A small file of any structure, inserted or graded, a builder or a compact form.
std::string whole_file(std::mt19937& random) {
    const auto any = [&](int end) { return static_cast<int>(random() % unsigned(end)); };
    const CatalogueEntry& entry = structures()[random() % structures().size()];
    SpaceOptions options;
    options.domain = {Point(0, 0, 0), Point(1, 1.5, any(4) == 0 ? 0 : 1)};
    options.octree_depth = 1 + any(2);
    options.kd_depth = 2 + any(5);
    options.voxel = 0.4;
    options.finest_length = 0.2;
    options.takes_later_sources = any(2) == 0;
    std::vector<PointSource> sources;
    for (int i = 0; i < 1 + any(4); ++i) {
        Metric m = Metric::isotropic(0.2 + 0.1 * any(5));
        if (any(2) == 0) m = {0.3, 0.2, 0.4, 0.02, -0.03, 0.05};
        sources.push_back({Point(0.1 * any(11), 0.15 * any(11), 0), m});
    }
    // A folder that is there in memory on any Linux: saving makes its file aside and renames it.
    const std::string path = "/dev/shm/controlspace-fuzz-" + std::to_string(::getpid());
    const auto builder = entry.make(options);
    builder->insert(sources);
    if (any(2) == 0) builder->grade({});
    if (any(3) == 0 && entry.has<CompactForm>()) {
        const auto precision = any(2) == 0 ? Precision::floats : Precision::doubles;
        save_control_space(path, *builder->build({.precision = precision}));
    } else {
        save_control_space(path, *builder);
    }
    const std::string bytes = read_binary_file(path);
    std::filesystem::remove(path);
    return bytes;
}

void change(Array& array, std::mt19937& random) {
    const std::size_t count = array.data.size() / sizeof(double);
    if (array.kind == 4 && count > 0 && random() % 2 == 0) {
        static constexpr double unlikely[] = {0,     -1,     1e308, -1e308, 1e-308, 5e-324,
                                              1e154, 1e-160, 0.5,   1e9,    NAN,    INFINITY};
        const double number = unlikely[random() % std::size(unlikely)];
        std::memcpy(array.data.data() + random() % count * sizeof number, &number, sizeof number);
        return;
    }
    std::vector<std::uint8_t> room(array.data.begin(), array.data.end());
    room.resize(array.data.size() + 2 * array.element_size);
    const std::size_t left = array.data.size();
    const std::size_t most = random() % 2 == 0 ? std::max<std::size_t>(left, 1) : room.size();
    std::size_t size = LLVMFuzzerMutate(room.data(), left, most);
    if (random() % 4 != 0) size = std::min(left, room.size());  // as many as before
    size -= size % std::max<std::size_t>(1, array.element_size);
    array.data.assign(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
}

}  // namespace

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                    unsigned seed) {
    std::mt19937 random(seed);
    std::string bytes(as_text(data, size));
    auto arrays = unpacked(bytes);
    if (!arrays || random() % 50 == 0) {
        bytes = whole_file(random);
        arrays = unpacked(bytes);
        require(arrays.has_value(), "a whole file is understood");
    }
    if (random() % 8 == 0) {
        std::vector<std::uint8_t> room(bytes.begin(), bytes.end());
        room.resize(std::max(most, room.size()));
        room.resize(LLVMFuzzerMutate(room.data(), bytes.size(), room.size()));
        bytes = repaired({room.begin(), room.end()});
    } else {
        change((*arrays)[random() % arrays->size()], random);
        bytes = packed(bytes, *arrays);
    }
    if (bytes.size() > most) return size;
    std::ranges::copy(bytes, data);
    return bytes.size();
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    static MemoryFile file;
    answers([&] {
        const auto path = file.with(repaired(std::string(as_text(data, size))));
        const SavedControlSpace saved = open_control_space(path, structures());
        const Box& box = saved.recipe.options.domain;
        std::vector<Point> x;
        for (int i = 0; i < 27; ++i) {
            const Vector at(i % 3, i / 3 % 3, i / 9);
            x.push_back(box.low + (at / 2).cwiseProduct(box.edges()));
            x.push_back(box.low + 0.37 * (at / 2).cwiseProduct(box.edges()));
        }
        std::vector<Metric> metrics(x.size());
        saved.space->sample(x, metrics);
        for (std::size_t i = 0; i < x.size(); ++i) {
            require(is_positive_definite(metrics[i]), to_string(metrics[i]) + " is an answer");
            if (const auto cell = saved.space->cell_at(x[i])) {
                require((cell->edges().array() >= 0).all(), "cells are boxes");
            }
        }
        require(saved.space->footprint().bytes_total() > 0, "it takes memory");
        if (saved.builder == nullptr) return;
        saved.builder->insert(std::vector<PointSource>{{box.centre(), metrics[13]}});
        saved.builder->grade({});
        saved.builder->build()->sample(x, metrics);
        for (const Metric& m : metrics) {
            require(is_positive_definite(m), to_string(m) + " after a later source and grading");
        }
    });
    return 0;
}

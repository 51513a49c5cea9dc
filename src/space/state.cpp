// SPDX-License-Identifier: Apache-2.0
#include "space/state.h"

#include <blosc.h>
#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "controlspace/error.h"
#include "controlspace/sources/point_source.h"
#include "geometry/threads.h"

namespace controlspace {

namespace {

// Small enough for a second-level cache, large enough for the compressor.
constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
// LZ4 expands a byte to 255 at most: a chunk that claims more is forged.
constexpr std::size_t largest_expansion = 256;
constexpr std::size_t largest_element = 255;  // that Blosc can shuffle

template <class T>
void append_value(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Takes values off the front of `bytes`; false where there are too few.
template <class T>
bool take_value(std::string_view& bytes, T& value) {
    if (bytes.size() < sizeof value) return false;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return true;
}

bool take_bytes(std::string_view& bytes, std::uint64_t count, std::string_view& taken) {
    if (bytes.size() < count) return false;
    taken = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return true;
}

// Whether Blosc's own sizes of an element and of a block, which it divides by and allocates without
// a look at them, fit a buffer that decompresses to `size` bytes.
bool has_sizes_of(std::string_view chunk, std::size_t element_size, std::size_t size) {
    std::uint32_t block = 0;
    std::memcpy(&block, chunk.data() + 8, sizeof block);
    return static_cast<unsigned char>(chunk[3]) == element_size && block > 0 && block <= size;
}

std::size_t chunk_elements(std::size_t element_size) {
    return std::max<std::size_t>(1, chunk_bytes / element_size);
}

std::size_t chunks_at_once() { return 2 * threads_allowed(); }

// Blosc works in two blocks, each no larger than what it is given, and in some memory more, and
// does not look whether it gets them: throws std::bad_alloc where they are not there.
void require_room_for_blosc(std::size_t size) {
    constexpr std::size_t more = std::size_t{1} << 16;
    const auto room = std::make_unique_for_overwrite<std::byte[]>(2 * size + more);
    *static_cast<volatile std::byte*>(room.get()) = {};  // or no memory is asked for
}

// Calls make(i) on all threads and, in the order of i, take(i) on one at a time; their results are
// exchanged in `room` places i % room.
template <class Make, class Take>
void in_order(std::size_t count, std::size_t room, const Make& make, const Take& take) {
    if (count == 1) {  // most arrays are single numbers: no other thread needs to wake up
        make(0);
        take(0);
    }
    if (count <= 1) return;
    std::size_t next = 0;
    const auto count_up = [&](tbb::flow_control& control) {
        if (next == count) control.stop();
        return next++;
    };
    const auto make_one = [&](std::size_t i) {
        make(i);
        return i;
    };
    using enum tbb::filter_mode;
    tbb::parallel_pipeline(room,
                           tbb::make_filter<void, std::size_t>(serial_in_order, count_up) &
                               tbb::make_filter<std::size_t, std::size_t>(parallel, make_one) &
                               tbb::make_filter<std::size_t, void>(serial_in_order, take));
}

}  // namespace

// An array is: size of the name (32 bits), name, kind (32), bytes of an element (32), number of
// elements (64), and its chunks, each as its size (32) and a buffer of Blosc's.
void StateWriter::append(std::string_view name, NumberKind kind, std::size_t element_size,
                         const void* data, std::size_t elements) {
    append_value(bytes_, static_cast<std::uint32_t>(name.size()));
    bytes_ += name;
    append_value(bytes_, static_cast<std::uint32_t>(kind));
    append_value(bytes_, static_cast<std::uint32_t>(element_size));
    append_value(bytes_, static_cast<std::uint64_t>(elements));
    const auto* from = static_cast<const char*>(data);
    const std::size_t step = chunk_elements(element_size);
    const std::size_t chunks = (elements + step - 1) / step;
    std::vector<std::string> compressed(std::min(chunks, chunks_at_once()));
    const auto compress = [&](std::size_t chunk) {
        const std::size_t first = chunk * step;
        const std::size_t size = std::min(step, elements - first) * element_size;
        std::string& out = compressed[chunk % compressed.size()];
        out.resize(size + BLOSC_MAX_OVERHEAD);
        require_room_for_blosc(size);
        constexpr int level = 5;
        constexpr int threads = 1;
        const int stored = blosc_compress_ctx(level, BLOSC_SHUFFLE, element_size, size,
                                              from + first * element_size, out.data(), out.size(),
                                              BLOSC_LZ4_COMPNAME, 0, threads);
        if (stored <= 0) throw std::runtime_error("Blosc cannot compress with LZ4");
        out.resize(static_cast<std::size_t>(stored));
    };
    in_order(chunks, compressed.size(), compress, [&](std::size_t chunk) {
        const std::string& stored = compressed[chunk % compressed.size()];
        append_value(bytes_, static_cast<std::uint32_t>(stored.size()));
        bytes_ += stored;
    });
}

StateReader::StateReader(std::string_view bytes, std::string file) : file_(std::move(file)) {
    while (!bytes.empty()) {
        std::uint32_t name_size = 0;
        std::uint32_t kind = 0;
        std::uint32_t element_size = 0;
        std::uint64_t elements = 0;
        std::string_view name = "an array";
        bool holds = take_value(bytes, name_size) && take_bytes(bytes, name_size, name) &&
                     take_value(bytes, kind) && take_value(bytes, element_size) &&
                     take_value(bytes, elements) && element_size > 0 &&
                     element_size <= largest_element;
        require(holds, name, "has no proper beginning");
        Array array{static_cast<NumberKind>(kind), element_size, elements, {}};
        const std::size_t step = chunk_elements(element_size);
        for (std::uint64_t left = elements; left > 0; left -= std::min<std::uint64_t>(left, step)) {
            std::uint32_t stored = 0;
            std::string_view chunk;
            std::size_t size = 0;
            holds = take_value(bytes, stored) && take_bytes(bytes, stored, chunk) &&
                    blosc_cbuffer_validate(chunk.data(), chunk.size(), &size) == 0 &&
                    size == std::min<std::uint64_t>(left, step) * element_size &&
                    has_sizes_of(chunk, element_size, size) &&
                    size <= largest_expansion * chunk.size();
            require(holds, name, "has a chunk that is no buffer of Blosc's of its size");
            array.chunks.push_back(chunk);
        }
        require(arrays_.emplace(name, std::move(array)).second, name, "is there twice");
    }
}

void StateReader::operator()(std::string_view name, std::string& text) const {
    std::vector<char> letters;
    (*this)(name, letters);
    text.assign(letters.begin(), letters.end());
}

void StateReader::fail(std::string_view name, std::string_view what) const {
    std::string printable(name.substr(0, 60));
    std::replace_if(
        printable.begin(), printable.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    throw InputError(
        fmt::format("{}: its {} {}: save the control space again", file_, printable, what));
}

const StateReader::Array& StateReader::find(std::string_view name, NumberKind kind,
                                            std::size_t element_size) const {
    const auto found = arrays_.find(name);
    if (found == arrays_.end()) fail(name, "is missing");
    require(found->second.kind == kind && found->second.element_size == element_size, name,
            "has numbers of another kind");
    return found->second;
}

// By way of pieces that stay in a cache: so that what they are appended to is written once.
void StateReader::decompress(std::string_view name, const Array& array,
                             const std::function<void(const void*, std::size_t)>& append) const {
    const std::size_t step = std::min(chunk_elements(array.element_size), array.elements);
    const auto elements = [&](std::size_t chunk) {
        return std::min(step, array.elements - chunk * step);
    };
    std::vector<std::unique_ptr<std::byte[]>> pieces(
        std::min(array.chunks.size(), chunks_at_once()));
    for (auto& piece : pieces) {
        piece = std::make_unique_for_overwrite<std::byte[]>(step * array.element_size);
    }
    const auto decompress_one = [&](std::size_t chunk) {
        const std::size_t size = elements(chunk) * array.element_size;
        require_room_for_blosc(size);
        constexpr int threads = 1;
        const int got = blosc_decompress_ctx(array.chunks[chunk].data(),
                                             pieces[chunk % pieces.size()].get(), size, threads);
        require(got >= 0 && static_cast<std::size_t>(got) == size, name, "cannot be decompressed");
    };
    in_order(array.chunks.size(), pieces.size(), decompress_one, [&](std::size_t chunk) {
        append(pieces[chunk % pieces.size()].get(), elements(chunk));
    });
}

void require_metrics(const StateReader& state, std::string_view name,
                     const std::vector<Metric>& metrics) {
    state.require(all_are(metrics, is_source_metric), name, "holds what is no metric");
}

}  // namespace controlspace

#include "spaces/state.h"

#include <blosc.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "error.h"

namespace controlspace {

namespace {

// Small enough for a second-level cache, large enough for the compressor.
constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
// LZ4 turns a byte into 255 at most: a chunk that says more lies.
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

std::size_t chunk_elements(std::size_t element_size) {
    return std::max<std::size_t>(1, chunk_bytes / element_size);
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
    for (std::size_t first = 0; first < elements; first += step) {
        const std::size_t size = std::min(step, elements - first) * element_size;
        const std::size_t start = bytes_.size() + sizeof(std::uint32_t);
        bytes_.resize(start + size + BLOSC_MAX_OVERHEAD);
        constexpr int level = 5;
        constexpr int threads = 1;
        const int stored = blosc_compress_ctx(
            level, BLOSC_SHUFFLE, element_size, size, from + first * element_size,
            bytes_.data() + start, size + BLOSC_MAX_OVERHEAD, BLOSC_LZ4_COMPNAME, 0, threads);
        if (stored <= 0) throw std::runtime_error("Blosc cannot compress with LZ4");
        const auto stored_size = static_cast<std::uint32_t>(stored);
        std::memcpy(bytes_.data() + start - sizeof stored_size, &stored_size, sizeof stored_size);
        bytes_.resize(start + stored_size);
    }
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

std::size_t StateReader::elements_per_chunk(std::size_t element_size) {
    return chunk_elements(element_size);
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

void StateReader::decompress(std::string_view name, std::string_view chunk, void* out,
                             std::size_t size) const {
    constexpr int threads = 1;
    const int got = blosc_decompress_ctx(chunk.data(), out, size, threads);
    require(got >= 0 && static_cast<std::size_t>(got) == size, name, "cannot be decompressed");
}

void require_metrics(const StateReader& state, std::string_view name,
                     const std::vector<Metric>& metrics) {
    state.require(std::all_of(metrics.begin(), metrics.end(), is_positive_definite), name,
                  "holds what is no metric");
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "damaged_copies.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string_view>

namespace controlspace {

namespace {

class Damage {
public:
    explicit Damage(std::uint32_t seed) : random_(seed) {}

    std::string operator()(std::string bytes) {
        const std::size_t times = 1 + below(3);
        for (std::size_t i = 0; i < times && !bytes.empty(); ++i) apply(bytes);
        return bytes;
    }

private:
    std::size_t below(std::size_t end) { return random_() % end; }

    void apply(std::string& bytes) {
        const std::size_t at = below(bytes.size());
        const std::size_t length = 1 + below(std::min<std::size_t>(64, bytes.size() - at));
        switch (below(7)) {
            case 0:
                bytes.resize(at);
                break;
            case 1:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
                break;
            case 2:
                bytes[at] = static_cast<char>(random_());
                break;
            case 3:
                bytes.erase(at, length);
                break;
            case 4:
                bytes.insert(at, bytes.substr(at, length));
                break;
            case 5:
                replace_written_number(bytes, at);
                break;
            default:
                replace_raw_number(bytes, at);
        }
    }

    void replace_written_number(std::string& bytes, std::size_t at) {
        static constexpr std::string_view lies[] = {
            "2000000000", "-1",  "0",   "4294967296", "99999999999999999999", "1e308",
            "-1e-308",    "nan", "inf", "x",          "9223372036854775807",  ""};
        constexpr std::string_view digits = "0123456789";
        const std::size_t first = bytes.find_first_of(digits, at);
        if (first == std::string::npos) return;
        const std::size_t last = std::min(bytes.find_first_not_of(digits, first), bytes.size());
        bytes.replace(first, last - first, lies[below(std::size(lies))]);
    }

    void replace_raw_number(std::string& bytes, std::size_t at) {
        static constexpr std::uint64_t lies[] = {
            0, ~std::uint64_t{0}, 0x7fffffff, 0x80000000, 2'000'000'000, 1ull << 40, 1ull << 63, 3};
        const std::uint64_t lie = lies[below(std::size(lies))];
        const std::size_t size = below(2) == 0 ? 4 : 8;
        at -= at % 4;
        std::memcpy(bytes.data() + at, &lie, std::min(size, bytes.size() - at));
    }

    std::mt19937 random_;
};

int from_environment(const char* name, int least) {
    const char* const text = std::getenv(name);
    return text != nullptr ? std::max(least, std::atoi(text)) : least;
}

}  // namespace

int for_each_damaged_copy(const std::string& bytes, int rounds,
                          const std::function<void(const std::string&)>& visit) {
    const int cuts = rounds / 3, all = rounds * from_environment("DAMAGED_FILES", 1);
    const auto first = static_cast<std::uint32_t>(from_environment("DAMAGED_FROM", 0));
    for (int i = 0; i <= cuts; ++i) {
        visit(bytes.substr(
            0, static_cast<std::size_t>(i) * bytes.size() / static_cast<std::size_t>(cuts)));
    }
    for (int round = 0; round < all; ++round) {
        visit(Damage(first + static_cast<std::uint32_t>(round))(bytes));
    }
    return cuts + 1 + all;
}

}  // namespace controlspace

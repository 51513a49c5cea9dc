// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace controlspace {

/// Writes what binary Medit files consist of, number by number, in any version and byte order.
class MeditBytes {
public:
    explicit MeditBytes(int version, bool swapped = false) : version_(version), swapped_(swapped) {
        word(1).word(version);
        block(3, 4).word(3);
    }

    template <class Number>
    MeditBytes& raw(Number number) {
        std::string bytes(reinterpret_cast<const char*>(&number), sizeof number);
        if (swapped_) std::reverse(bytes.begin(), bytes.end());
        bytes_ += bytes;
        return *this;
    }
    MeditBytes& word(std::int32_t n) { return raw(n); }
    /// A count, an index or a reference.
    MeditBytes& integer(std::int64_t n) {
        return version_ < 4 ? word(static_cast<int>(n)) : raw(n);
    }
    MeditBytes& real(double x) { return version_ == 1 ? raw(static_cast<float>(x)) : raw(x); }
    /// A keyword, and that `size` bytes follow it before the next one.
    MeditBytes& block(std::int32_t code, std::size_t size) {
        word(code);
        const std::size_t next = bytes_.size() + (version_ < 3 ? 4 : 8) + size;
        return place(static_cast<std::int64_t>(next));
    }
    MeditBytes& place(std::int64_t at) {
        return version_ < 3 ? word(static_cast<int>(at)) : raw(at);
    }
    MeditBytes& end() { return word(54).place(0); }

    std::size_t integer_size() const { return version_ < 4 ? 4 : 8; }
    std::size_t real_size() const { return version_ == 1 ? 4 : 8; }
    const std::string& bytes() const { return bytes_; }

private:
    int version_;
    bool swapped_;
    std::string bytes_;
};

}  // namespace controlspace

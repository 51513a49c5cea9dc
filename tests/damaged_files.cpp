// SPDX-License-Identifier: Apache-2.0
#include "damaged_files.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "controlspace/error.h"
#include "counting_allocator.h"
#include "damaged_copies.h"

namespace controlspace {

namespace {

void check_reading(const std::filesystem::path& file, const std::string& bytes,
                   std::size_t bytes_per_byte,
                   const std::function<void(const std::filesystem::path&)>& read) {
    std::ofstream(file, std::ios::binary) << bytes;
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    std::string what;
    try {
        read(file);
    } catch (const InputError& error) {
        what = error.what();
        CHECK(!what.empty());
        CHECK(what.find('\n') == std::string::npos);
    } catch (const std::exception& error) {
        FAIL_CHECK("no InputError: " << error.what());
    }
    CAPTURE(what, bytes.size());
    CHECK(peak_bytes() - before <= 100'000 + bytes_per_byte * bytes.size());
}

}  // namespace

void check_damaged_files(const std::filesystem::path& folder, const std::string& name,
                         const std::string& bytes, std::size_t bytes_per_byte,
                         const std::function<void(const std::filesystem::path&)>& read) {
    CAPTURE(name);
    int copy = 0;
    for_each_damaged_copy(bytes, 100, [&](const std::string& damaged) {
        CAPTURE(copy++);
        check_reading(folder / name, damaged, bytes_per_byte, read);
    });
    std::ofstream(folder / name, std::ios::binary) << bytes;
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "space/sealed_vdb.h"

#define XXH_INLINE_ALL  // nothing to link with
#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>

#include "controlspace/error.h"

namespace controlspace {

namespace {

constexpr std::string_view magic{" BDV\0\0\0\0", 8};
constexpr std::size_t searched = 512;  // the seal is the first metadatum, by its name
// Between the name of a metadatum and its value: two lengths of 32 bits and the type, "string".
constexpr std::size_t between = 4 + 6 + 4;

std::size_t place_of_seal(std::string_view bytes) {
    const std::size_t name = bytes.substr(0, searched).find(seal_name);
    if (name == bytes.npos) return bytes.npos;
    const std::size_t digits = name + seal_name.size() + between;
    return digits + unsealed.size() > bytes.size() ? bytes.npos : digits;
}

std::string checksum_of(std::string_view bytes) {
    return fmt::format("{:016x}", std::uint64_t{XXH3_64bits(bytes.data(), bytes.size())});
}

}  // namespace

bool is_vdb(std::string_view beginning) { return beginning.starts_with(magic); }

bool is_sealed_vdb(std::string_view beginning) {
    return is_vdb(beginning) && place_of_seal(beginning) != beginning.npos;
}

void seal_vdb(std::string& bytes) {
    bytes.replace(place_of_seal(bytes), unsealed.size(), checksum_of(bytes));
}

void require_sealed_vdb(std::string bytes, const std::string& file) {
    const std::size_t seal = place_of_seal(bytes);
    if (seal == bytes.npos) {
        throw InputError(file +
                         " holds grids of OpenVDB, but no control space: give it as a field "
                         "(field_file), or as a surface");
    }
    const std::string written = bytes.substr(seal, unsealed.size());
    bytes.replace(seal, unsealed.size(), unsealed);
    if (checksum_of(bytes) != written) {
        throw InputError(file +
                         " is truncated or altered (its checksum differs): copy it again, or save "
                         "the control space again");
    }
}

}  // namespace controlspace

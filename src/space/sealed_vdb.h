// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace controlspace {

// OpenVDB's files of control spaces. Among the metadata of the whole file, which other programs do
// not keep, is a checksum of all bytes: it tells such a file from a picture of a field and from
// what another program has changed, and lets no damaged file come to OpenVDB, which does not check
// what it reads.

/// The metadatum, a text of 16 hexadecimal digits: XXH3 of the file with zeros in their place.
inline constexpr std::string_view seal_name = "controlspace_checksum";
inline constexpr std::string_view unsealed = "0000000000000000";

/// Whether a file that begins so, with some hundred bytes, is OpenVDB's.
bool is_vdb(std::string_view beginning);
/// The same with a seal.
bool is_sealed_vdb(std::string_view beginning);

/// Writes the checksum into a file that was made with `unsealed`.
void seal_vdb(std::string& bytes);
/// Throws InputError, which names `file`, for what is not sealed, or altered.
void require_sealed_vdb(std::string bytes, const std::string& file);

}  // namespace controlspace

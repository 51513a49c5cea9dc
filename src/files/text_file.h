// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace controlspace {

/// Maximum bytes read from a pipe or a device, which may never end: some six million sources.
constexpr std::size_t largest_stream = std::size_t{1} << 30;

/// Throws InputError for a pipe or a device, which cannot be read more than once, as libraries do.
void require_no_stream(const std::filesystem::path& path);

/// The whole file, without a leading UTF-8 byte order mark. Throws InputError, naming the file, if
/// it is missing, a directory, unreadable or empty, if it holds a zero byte, as no text does, or if
/// it goes on for `largest` bytes beyond the size that it has on disk (a pipe has none).
std::string read_text_file(const std::filesystem::path& path, std::size_t largest = largest_stream);

/// The same for a file that may be binary: as it is, zero bytes and all.
std::string read_binary_file(const std::filesystem::path& path,
                             std::size_t largest = largest_stream);

/// What was read as binary, as a text: throws as read_text_file does.
std::string_view text_in(std::string_view bytes, const std::filesystem::path& path);

/// "name:line", for messages.
std::string place(const std::filesystem::path& path, std::size_t line);

/// A piece of a file as a message can quote it: its beginning, in printable characters.
std::string quote(std::string_view text);

/// `text` with small letters in place of capital ones (ASCII).
std::string lower_case(std::string text);

/// The parts of `text` between separators: one more than there are separators.
std::vector<std::string_view> split(std::string_view text, char separator);

/// ", did you mean NAME?", for the name that `word` was most likely to be: at most a third of its
/// letters are wrong, missing, too many or exchanged with the next one. Otherwise empty.
std::string did_you_mean(std::string_view word, std::span<const std::string> names);

/// Index in `names` of the array that is called `wanted`; of the only one, if that is empty. Throws
/// InputError that lists them if there is none, or more than one. `kind` is "views", for messages.
std::size_t chosen_array(const std::filesystem::path& path, std::string_view kind,
                         std::span<const std::string> names, const std::string& wanted);

/// Index in `steps`, the numbers of a view's steps in time, of the step `wanted`; of the last one
/// if there is none, which `remark` is then told where there are more. Throws InputError that lists
/// them if there is no such step.
std::size_t chosen_step(const std::filesystem::path& path, std::string_view view,
                        std::span<const std::uint64_t> steps, std::optional<std::uint64_t> wanted,
                        const std::function<void(const std::string&)>& remark);

/// Whether all of `text` is a number that fits into `value`; a leading + is allowed.
template <class Number>
bool parse_number(std::string_view text, Number& value) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stop == end;
}

}  // namespace controlspace

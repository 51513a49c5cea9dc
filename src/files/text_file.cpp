// SPDX-License-Identifier: Apache-2.0
#include "files/text_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>

#include "refuse.h"

namespace controlspace {

namespace {

[[noreturn]] void fail_with_zero_byte(const std::filesystem::path& path) {
    refuse("{} holds a zero byte: give a text file", path.string());
}

/// Stops early where a text holds a zero byte: a device may send nothing else, without an end.
std::string read_file(const std::filesystem::path& path, std::size_t largest, bool is_text) {
    const std::string name = path.string();
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        refuse("{} is a directory: name a file", name);
    }
    const auto close = [](std::FILE* f) { std::fclose(f); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(name.c_str(), "rb"), close);
    if (!file) refuse("cannot read {}: {}", name, std::strerror(errno));

    std::string bytes;
    constexpr std::size_t block = std::size_t{1} << 16;
    std::error_code no_size;  // of a pipe
    const std::uintmax_t known_size = std::filesystem::file_size(path, no_size);
    const std::uintmax_t size_on_disk = no_size ? 0 : known_size;
    bytes.reserve(size_on_disk + block);
    std::size_t got = block;
    while (got == block) {
        const std::size_t size = bytes.size();
        bytes.resize(size + block);
        got = std::fread(bytes.data() + size, 1, block, file.get());
        bytes.resize(size + got);
        if (is_text && bytes.find('\0', size) != std::string::npos) fail_with_zero_byte(path);
        if (bytes.size() > size_on_disk + largest) {
            refuse("{} does not end after {} bytes: give a file", name, size_on_disk + largest);
        }
    }
    if (std::ferror(file.get()) != 0) refuse("cannot read {}: {}", name, std::strerror(errno));
    if (bytes.empty()) refuse("{} is empty: name another file", name);
    return bytes;
}

}  // namespace

void require_no_stream(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_other(path, ignored)) return;
    refuse_at(path, "a pipe or a device, which can be read only once: save it as a file");
}

std::string read_text_file(const std::filesystem::path& path, std::size_t largest) {
    std::string text;
    if (path == "/dev/stdin") {
        static const std::string once = read_file(path, largest, true);  // what is read is gone
        text = once;
    } else {
        text = read_file(path, largest, true);
    }
    text.erase(0, text.size() - text_in(text, path).size());
    return text;
}

std::string read_binary_file(const std::filesystem::path& path, std::size_t largest) {
    return read_file(path, largest, false);
}

std::string_view text_in(std::string_view bytes, const std::filesystem::path& path) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (bytes.find('\0') != std::string_view::npos) fail_with_zero_byte(path);
    if (bytes.starts_with(byte_order_mark)) bytes.remove_prefix(byte_order_mark.size());
    if (bytes.empty()) refuse("{} is empty: name another file", path.string());
    return bytes;
}

std::string place(const std::filesystem::path& path, std::size_t line) {
    return fmt::format("{}:{}", path.string(), line);
}

std::string quote(std::string_view text) {
    constexpr std::size_t most = 40;
    std::string shown = "'";
    for (const char c : text.substr(0, most)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (text.size() > most ? "...'" : "'");
}

std::string lower_case(std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c;
    return text;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size(); begin += parts.back().size() + 1) {
        parts.push_back(text.substr(begin, text.find(separator, begin) - begin));
    }
    return parts;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> names) {
    // Changes from the beginning of `word` to that of `name`: the last three rows of the table of
    // the optimal string alignment distance.
    const auto changes = [&](std::string_view name) {
        std::vector<std::size_t> before, last, now(name.size() + 1);
        std::iota(now.begin(), now.end(), std::size_t{0});
        for (std::size_t i = 1; i <= word.size(); ++i) {
            before = std::exchange(last, now);
            now[0] = i;
            for (std::size_t j = 1; j <= name.size(); ++j) {
                const std::size_t other = word[i - 1] == name[j - 1] ? 0 : 1;
                now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + other});
                if (i > 1 && j > 1 && word[i - 1] == name[j - 2] && word[i - 2] == name[j - 1]) {
                    now[j] = std::min(now[j], before[j - 2] + 1);
                }
            }
        }
        return now.back();
    };
    std::size_t fewest = word.size() / 3 + 1;
    std::string_view nearest;
    for (const std::string& name : names) {
        if (const std::size_t n = changes(name); n < fewest) {
            fewest = n;
            nearest = name;
        }
    }
    return nearest.empty() ? "" : fmt::format(", did you mean {}?", nearest);
}

std::size_t chosen_array(const std::filesystem::path& path, std::string_view kind,
                         std::span<const std::string> names, const std::string& wanted) {
    std::vector<std::string> quoted;
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < names.size(); ++i) {
        quoted.push_back(quote(names[i]));
        if (wanted.empty() || names[i] == wanted) chosen.push_back(i);
    }
    if (chosen.size() == 1) return chosen.front();
    refuse_at(path, "{} of its {} can be meant: name one of {} (--source-array)", chosen.size(),
              kind, fmt::join(quoted, ", "));
}

std::size_t chosen_step(const std::filesystem::path& path, std::string_view view,
                        std::span<const std::uint64_t> steps, std::optional<std::uint64_t> wanted,
                        const std::function<void(const std::string&)>& remark) {
    if (!wanted) {
        if (steps.size() > 1 && remark) {
            remark(
                fmt::format("{}: view {} has {} steps in time: the last is taken, number {} "
                            "(--source-step chooses)",
                            path.string(), quote(view), steps.size(), steps.back()));
        }
        return steps.size() - 1;
    }
    const auto found = std::ranges::find(steps, *wanted);
    if (found != steps.end()) return static_cast<std::size_t>(found - steps.begin());
    constexpr std::size_t shown = 10;
    refuse_at(path, "view {} has no step {} in time: name one of {}{} (--source-step)", quote(view),
              *wanted, fmt::join(steps.first(std::min(shown, steps.size())), ", "),
              steps.size() > shown ? fmt::format(", ..., {}", steps.back()) : "");
}

}  // namespace controlspace

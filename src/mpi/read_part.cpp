// SPDX-License-Identifier: Apache-2.0
#include "mpi/read_part.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>

#include "controlspace/error.h"
#include "io/text/csv.h"
#include "refuse.h"

namespace controlspace {
namespace {

bool is_empty(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    return first == std::string_view::npos || line[first] == '#';
}

// The names of the columns, then the lines that begin in the part.
std::string lines_of_part(const std::filesystem::path& path, int part, int parts) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        refuse("cannot read {} by parts: give a file, not a pipe", path.string());
    }
    std::ifstream file(path, std::ios::binary);
    std::string text, line;
    while (std::getline(file, text) && is_empty(text)) {
    }
    if (!file) return {};
    text += '\n';
    const auto first = static_cast<std::uint64_t>(file.tellg());
    const std::uint64_t size = std::filesystem::file_size(path) - first;
    const auto border = [&](int p) {
        return first + size * static_cast<std::uint64_t>(p) / static_cast<std::uint64_t>(parts);
    };
    const std::uint64_t begin = border(part), end = border(part + 1);
    if (begin > first) {  // to the next beginning of a line
        file.seekg(static_cast<std::streamoff>(begin - 1));
        std::getline(file, line);
    }
    const auto from = static_cast<std::uint64_t>(file.tellg());
    if (!file || from >= end) return {};
    const std::size_t names = text.size();
    text.resize(names + static_cast<std::size_t>(end - from));
    file.read(text.data() + names, static_cast<std::streamsize>(end - from));
    if (text.back() != '\n' && std::getline(file, line)) text += line;
    for (std::size_t at = names; at < text.size();) {
        const std::size_t end_of_line = std::min(text.find('\n', at), text.size());
        if (!is_empty(std::string_view(text).substr(at, end_of_line - at))) return text;
        at = end_of_line + 1;
    }
    return {};
}

}  // namespace

std::vector<PointSource> read_csv_part(const std::filesystem::path& path, int part, int parts) {
    const std::string text = lines_of_part(path, part, parts);
    if (text.empty() && part > 0) return {};
    try {
        if (!text.empty()) return parse_csv_sources(text, path);
    } catch (const InputError&) {
        read_csv_sources(path);  // its message has the right line
        throw;
    }
    read_csv_sources(path);  // it may be empty, which none but the first part finds out
    return {};
}

}  // namespace controlspace

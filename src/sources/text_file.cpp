#include "sources/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "error.h"

namespace controlspace {

std::string read_text_file(const std::filesystem::path& path, std::size_t largest) {
    const std::string name = path.string();
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) {
        throw InputError(fmt::format("{} is a directory: name a file", name));
    }
    const auto close = [](std::FILE* f) { std::fclose(f); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(name.c_str(), "rb"), close);
    if (!file) throw InputError(fmt::format("cannot read {}: {}", name, std::strerror(errno)));

    std::string text;
    constexpr std::size_t block = std::size_t{1} << 16;
    std::error_code no_size;  // of a pipe
    const std::uintmax_t known_size = std::filesystem::file_size(path, no_size);
    const std::uintmax_t size_on_disk = no_size ? 0 : known_size;
    text.reserve(size_on_disk + block);
    std::size_t got = block;
    while (got == block) {
        const std::size_t size = text.size();
        text.resize(size + block);
        got = std::fread(text.data() + size, 1, block, file.get());
        text.resize(size + got);
        if (text.find('\0', size) != std::string::npos) {
            throw InputError(fmt::format("{} holds a zero byte: give a text file", name));
        }
        if (text.size() > size_on_disk + largest) {
            throw InputError(fmt::format("{} does not end after {} bytes: give a file", name,
                                         size_on_disk + largest));
        }
    }
    if (std::ferror(file.get()) != 0) {
        throw InputError(fmt::format("cannot read {}: {}", name, std::strerror(errno)));
    }
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    if (text.empty()) throw InputError(fmt::format("{} is empty: name another file", name));
    return text;
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

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "io/text/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say so");

// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html: these eight bytes, the
// length of the header in two bytes (four from version 2 on), and the header, a dictionary of
// Python.
constexpr std::string_view magic("\x93NUMPY\x01\x00", 8);

/// A file that is read from front to back.
class Bytes {
public:
    explicit Bytes(const std::filesystem::path& path)
        : path_(path), file_(std::fopen(path.string().c_str(), "rb"), &std::fclose) {
        if (!file_) refuse_at(path, "cannot read: {}", std::strerror(errno));
    }
    void read(void* to, std::size_t count) {
        if (std::fread(to, 1, count, file_.get()) == count) return;
        if (std::ferror(file_.get()) != 0) refuse_at(path_, "{}", std::strerror(errno));
        refuse_at(path_, "it is cut off: save it again by numpy.save");
    }
    std::string text(std::size_t count) {
        std::string text(count, ' ');
        read(text.data(), count);
        return text;
    }
    std::uintmax_t position() const { return static_cast<std::uintmax_t>(std::ftell(file_.get())); }

private:
    const std::filesystem::path& path_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

/// The value of a key of the header, up to a separator.
std::string_view value_of(std::string_view header, std::string_view key, std::string_view end) {
    const std::size_t at = header.find(fmt::format("'{}':", key));
    if (at == header.npos) return {};
    std::string_view value = header.substr(at + key.size() + 3);
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    return value.substr(0, value.find(end));
}

struct Shape {
    std::size_t rows = 0, columns = 0;
    bool is_float = false;  ///< of 32 bits
};

Shape read_header(Bytes& bytes, const std::filesystem::path& path) {
    const std::string start = bytes.text(magic.size());
    const auto version = static_cast<unsigned char>(start[6]);
    if (start.substr(0, 6) != magic.substr(0, 6) || version < 1 || version > 3) {
        refuse_at(path, "it is no array of NumPy: save it by numpy.save");
    }
    std::uint32_t size = 0;
    bytes.read(&size, version == 1 ? 2 : 4);
    constexpr std::uint32_t most = 1 << 16;
    if (size > most) refuse_at(path, "its header is damaged: save it again by numpy.save");
    const std::string header = bytes.text(size);
    const std::string_view type = value_of(header, "descr", ",");
    if (type != "'<f8'" && type != "'<f4'") {
        refuse_at(path, "it holds no floats or doubles: save array.astype('<f8')");
    }
    if (value_of(header, "fortran_order", ",") != "False") {
        refuse_at(path, "it is stored by columns: save numpy.ascontiguousarray(array)");
    }
    Shape shape{.is_float = type == "'<f4'"};
    const std::string_view both = value_of(header, "shape", ")");  // "(2, 5"
    const std::size_t comma = both.find(", ");
    const bool are_two = both.starts_with('(') && comma != both.npos &&
                         parse_number(both.substr(1, comma - 1), shape.rows) &&
                         parse_number(both.substr(comma + 2), shape.columns);
    if (!are_two || (shape.columns != 4 && shape.columns != 5) || shape.rows == 0) {
        refuse_at(path, "its shape is {}): give rows x, y, z, h or x, y, z, h, g", both);
    }
    return shape;
}

PointSource source_of(std::span<const double> row, std::size_t index,
                      const std::filesystem::path& path) {
    const auto require = [&](bool fits, std::string_view name, double value,
                             std::string_view rule) {
        if (!fits) refuse("{}, row {}: {} = {}: {}", path.string(), index, name, value, rule);
    };
    for (std::size_t a = 0; a < 3; ++a) {
        require(is_coordinate(row[a]), std::string_view("xyz").substr(a, 1), row[a],
                "give a finite number, of at most 1e+50");
    }
    require(is_length(row[3]), "h", row[3], length_rule);
    const double growth = row.size() > 4 ? row[4] : 0;
    require(is_source_growth(growth), "g", growth, growth_rule);
    return {Point(row.data()), Metric::isotropic(row[3]), growth};
}

}  // namespace

std::string npy_header(std::string_view shape) {
    constexpr std::size_t alignment = 64;  // of the numbers
    std::string header =
        fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}", shape);
    const std::size_t unpadded = magic.size() + 2 + header.size() + 1;
    header.append((alignment - unpadded % alignment) % alignment, ' ').append("\n");
    std::string bytes(magic);
    bytes.push_back(static_cast<char>(header.size() % 256));
    bytes.push_back(static_cast<char>(header.size() / 256));
    return bytes.append(header);
}

std::vector<PointSource> read_npy_sources(const std::filesystem::path& path) {
    require_no_stream(path);
    Bytes bytes(path);
    const auto [rows, columns, is_float] = read_header(bytes, path);
    // Before memory is allocated for them.
    const std::uintmax_t numbers = (std::filesystem::file_size(path) - bytes.position()) /
                                   (is_float ? sizeof(float) : sizeof(double));
    if (numbers / columns < rows) {
        refuse_at(path, "it has {} of {} rows: save it again by numpy.save", numbers / columns,
                  rows);
    }
    std::vector<PointSource> sources;
    sources.reserve(rows);
    std::array<double, 5> row{};
    const std::span<double> used = std::span(row).first(columns);
    std::array<float, 5> narrow{};
    for (std::size_t i = 0; i < rows; ++i) {
        if (is_float) {
            bytes.read(narrow.data(), columns * sizeof(float));
            std::copy_n(narrow.begin(), columns, row.begin());
        } else {
            bytes.read(used.data(), used.size_bytes());
        }
        sources.push_back(source_of(used, i, path));
    }
    return sources;
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/octree_pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/space/control_space_file.h"
#include "files/output_file.h"
#include "files/text_file.h"
#include "trees/topology/topology.h"

namespace controlspace {
namespace {

constexpr std::string_view first_line = "controlspace pieces 1";
constexpr std::string_view piece_word = "piece ";

std::string text_of(const Box& box) {
    return fmt::format("{},{},{},{},{},{}", box.low.x(), box.low.y(), box.low.z(), box.high.x(),
                       box.high.y(), box.high.z());
}

/// Removes what comes before the first `separator` from `text`, and returns it.
std::string_view cut_front(std::string_view& text, char separator) {
    const std::size_t end = text.find(separator);
    const std::string_view front = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return front;
}

/// By which a file is told from those of other runs: its own checksum, which ends it.
std::string checksum_of(const std::filesystem::path& file) {
    std::array<unsigned char, 8> end{};
    std::ifstream bytes(file, std::ios::binary);
    bytes.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
    bytes.read(reinterpret_cast<char*>(end.data()), end.size());
    if (!bytes) throw InputError(file.string() + " is no piece of an octree, or cannot be read");
    return fmt::format("{:02x}", fmt::join(end, ""));
}

/// What an index says.
struct Index {
    Box domain;
    std::vector<std::string> names, checksums;
    std::vector<Box> octants;
    std::vector<std::uint32_t> piece_of;  ///< by octant, a name's number
};

class IndexReader {
public:
    explicit IndexReader(const std::filesystem::path& path)
        : path_(path), bytes_(read_text_file(path)), rest_(bytes_) {}

    Index read() {
        if (line() != first_line) {
            fail("no index of pieces: give a .pctrl that controlspace-mpi has written");
        }
        Index index;
        line();
        index.domain = box();
        require_extent(index.domain);
        while (!rest_.empty()) {
            line();
            if (line_.starts_with(piece_word)) {
                add_piece(index);
            } else {
                if (index.names.empty()) fail("no piece for this octant");
                index.octants.push_back(box());
                index.piece_of.push_back(static_cast<std::uint32_t>(index.names.size() - 1));
            }
        }
        return index;
    }

private:
    std::string_view line() {
        ++number_;
        return line_ = cut_front(rest_, '\n');
    }
    void add_piece(Index& index) {
        const std::size_t space = line_.rfind(' ');
        const std::string name(line_.substr(piece_word.size(), space - piece_word.size()));
        // A name alone: nothing outside of the index's folder is read.
        if (space < piece_word.size() || name.empty() || name[0] == '.' ||
            name != std::filesystem::path(name).filename()) {
            fail(quote(line_) + " names no piece beside the index");
        }
        index.names.push_back(name);
        index.checksums.emplace_back(line_.substr(space + 1));
    }
    /// Of the line.
    Box box() {
        std::array<double, 6> ends;
        for (double& end : ends) {
            const std::string_view number = cut_front(line_, ',');
            if (!parse_number(number, end)) fail(quote(number) + " is no coordinate");
        }
        return {{ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}};
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}", place(path_, number_), what));
    }

    const std::filesystem::path& path_;
    std::string bytes_;
    std::string_view rest_, line_;
    std::size_t number_ = 0;
};

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

class OctreeInPieces final : public ControlSpace {
public:
    OctreeInPieces(const Index& index, const std::filesystem::path& path,
                   std::span<const CatalogueEntry> structures, const Box& region)
        : domain_{index.domain.low.cwiseMax(region.low), index.domain.high.cwiseMin(region.high)},
          octants_(index.domain),
          pieces_(index.names.size()) {
        if (!(domain_.low.array() <= domain_.high.array()).all()) {
            throw InputError(fmt::format("{}: its domain {} has nothing in {}", path.string(),
                                         to_string(index.domain), to_string(region)));
        }
        for (const Box& octant : index.octants) cut_to(octant, path);
        octants_.fit_jumps();
        piece_of_.assign(octants_.leaves(), none);
        for (std::size_t i = 0; i < index.octants.size(); ++i) {
            const Box& octant = index.octants[i];
            std::uint32_t& piece = piece_of_[octants_.find(octant.centre())];
            if (cell(octant) != octant || piece != none) fail_octant(octant, path);
            piece = index.piece_of[i];
            if (!touch(octant, domain_) || pieces_[piece]) continue;
            const auto file = path.parent_path() / index.names[piece];
            if (checksum_of(file) != index.checksums[piece]) {
                throw InputError(fmt::format("{} is of another run than {}: write both again",
                                             file.string(), path.string()));
            }
            pieces_[piece] = load_control_space(file, structures);
            if (pieces_[piece]->domain() != index.domain) {
                throw InputError(fmt::format("{}: its domain {} is not that of {}", file.string(),
                                             to_string(pieces_[piece]->domain()), path.string()));
            }
        }
        if (std::ranges::count(piece_of_, none) > 0) {
            throw InputError(path.string() + ": its octants leave a part of the domain out");
        }
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        sample_by_piece(x, out, [](const ControlSpace& piece, auto points, auto answers) {
            piece.sample(points, answers);
        });
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        sample_by_piece(x, out, [](const ControlSpace& piece, auto points, auto answers) {
            piece.sample_lengths(points, answers);
        });
    }
    Metric metric_at(const Point& x) const override {
        const Point inside = nearest_in(domain_, x);
        return piece_at(inside).metric_at(inside);
    }
    double length_at(const Point& x) const override {
        const Point inside = nearest_in(domain_, x);
        return piece_at(inside).length_at(inside);
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint all;
        octants_.describe(all);
        all.tree_nodes = all.cells = 0;
        all.bytes_topology += piece_of_.capacity() * sizeof(std::uint32_t);
        for (const auto& piece : pieces_) {
            if (!piece) continue;
            const Footprint one = piece->footprint();
            all.tree_nodes += one.tree_nodes;
            all.cells += one.cells;
            all.control_nodes += one.control_nodes;
            all.depth = std::max(all.depth, one.depth);
            all.bytes_payload += one.bytes_payload;
            all.bytes_topology += one.bytes_topology;
            all.bytes_auxiliary += one.bytes_auxiliary;
        }
        return all;
    }
    std::optional<Box> cell_at(const Point& x) const override {
        const Point inside = nearest_in(domain_, x);
        return piece_at(inside).cell_at(inside);
    }

private:
    [[noreturn]] static void fail_octant(const Box& octant, const std::filesystem::path& path) {
        throw InputError(fmt::format("{}: {} is no octant of its domain, or there twice",
                                     path.string(), to_string(octant)));
    }

    Box cell(const Box& octant) const { return octants_.locate(octant.centre()).box; }

    void cut_to(const Box& octant, const std::filesystem::path& path) {
        while (true) {
            const LeafPlace leaf = octants_.locate(octant.centre());
            if (leaf.box == octant) return;
            const Subdivision halves =
                OctreeNode::even_subdivision(octants_.domain(), leaf.level, leaf.box);
            const bool holds = leaf.box.contains(octant.low) && leaf.box.contains(octant.high);
            if (!holds || !halves.is_proper()) fail_octant(octant, path);
            octants_.split(leaf, halves);
        }
    }

    const ControlSpace& piece_at(const Point& inside) const {
        return *pieces_[piece_of_[octants_.find(inside)]];
    }

    /// Calls ask(piece, points, answers) once for each piece that holds some of the points.
    template <class Value, class Ask>
    void sample_by_piece(std::span<const Point> x, std::span<Value> out, const Ask& ask) const {
        std::vector<Point> inside(x.size());
        std::vector<std::uint32_t> piece(x.size());
        std::vector<std::size_t> order(x.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (std::size_t i = 0; i < x.size(); ++i) {
            inside[i] = nearest_in(domain_, x[i]);
            piece[i] = piece_of_[octants_.find(inside[i])];
        }
        std::ranges::stable_sort(order, {}, [&](std::size_t i) { return piece[i]; });
        std::vector<Point> points;
        std::vector<Value> answers;
        for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
            points.clear();
            for (end = begin; end < order.size() && piece[order[end]] == piece[order[begin]]; ++end)
                points.push_back(inside[order[end]]);
            answers.resize(points.size());
            ask(*pieces_[piece[order[begin]]], std::span<const Point>(points),
                std::span<Value>(answers));
            for (std::size_t k = begin; k < end; ++k) out[order[k]] = answers[k - begin];
        }
    }

    Box domain_;
    Topology<OctreeNode> octants_;
    std::vector<std::uint32_t> piece_of_;  // by octant
    std::vector<std::unique_ptr<ControlSpace>> pieces_;
};

}  // namespace

void write_octree_pieces(const std::filesystem::path& index, const Box& domain,
                         std::span<const OctreePiece> pieces) {
    OutputFile out(index);
    out.print("{}\n{}\n", first_line, text_of(domain));
    for (const OctreePiece& piece : pieces) {
        out.print("{}{} {}\n", piece_word, piece.file.filename().string(), checksum_of(piece.file));
        for (const Box& octant : piece.octants) out.print("{}\n", text_of(octant));
    }
    out.commit();
}

std::unique_ptr<ControlSpace> load_octree_pieces(const std::filesystem::path& index,
                                                 std::span<const CatalogueEntry> structures,
                                                 const Box& region) {
    return std::make_unique<OctreeInPieces>(IndexReader(index).read(), index, structures, region);
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "io/text/msh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Data of one name, of one step in time.
struct View {
    std::uint64_t step = 0;
    std::uint64_t components = 0;
    std::map<std::uint64_t, std::vector<double>> rows = {};  ///< by node or element
    std::set<std::uint64_t> steps = {};                      ///< all that the file has
};
using Views = std::map<std::string, View>;

/// Where data are, in the order in which they are preferred.
struct Kind {
    std::string_view section;
    const char* row;  ///< what one row is of
};
constexpr std::array<Kind, 3> kinds{
    {{"NodeData", "node"}, {"ElementData", "element"}, {"ElementNodeData", "element"}}};
constexpr std::size_t at_nodes = 0, at_corners = 2;

/// Of the element types that Gmsh writes; 0 for unknown ones.
std::size_t nodes_of_element(std::int32_t type) {
    constexpr std::array<std::uint8_t, 32> nodes{0,  2,  3,  4,  4, 8, 6,  5,  3,  6, 9,
                                                 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10,
                                                 12, 15, 15, 21, 4, 5, 6,  20, 35, 56};
    return type > 0 && static_cast<std::size_t>(type) < nodes.size()
               ? nodes[static_cast<std::size_t>(type)]
               : 0;
}

/// Reads a file section by section; passes over all but nodes and data.
class Parser {
public:
    Parser(std::string_view bytes, const std::filesystem::path& path, const ReadOptions& options)
        : file_(bytes, path), options_(options) {
        read_format();
        while (find_section()) {
            if (section_ == "Nodes") is_old_ ? read_old_nodes() : read_nodes();
            if (section_ == "Elements") elements_at_ = file_.at();
            for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
                if (section_ == kinds[kind].section) read_data(kind);
            }
            const std::size_t end = file_.rest().find("$End" + section_);
            file_.go_to(file_.at() + std::min(end, file_.rest().size()));
        }
    }

    std::vector<PointSource> sources() {
        const std::filesystem::path& path = file_.path();
        const std::size_t kind = chosen_kind();
        std::vector<std::string> names;
        for (const auto& [name, data] : views_[kind]) names.push_back(name);
        if (!options_.array.empty()) names = all_names();
        const std::string& name = names[chosen_array(path, "views", names, options_.array)];
        const View& data = views_[kind].at(name);
        const std::vector<std::uint64_t> steps(data.steps.begin(), data.steps.end());
        chosen_step(path, name, steps, options_.step, options_.remark);
        if (data.components != 1 && data.components != matrix_rows.numbers) {
            refuse_at(path, "{} components: give 1 (sizes) or 9 (tensors)", data.components);
        }
        const char* what = kinds[kind].row;
        if (data.rows.empty()) refuse_at(path, "no data at any {}: nothing to read", what);
        if (kind != at_nodes) read_elements(data);
        const auto where = [&] { return path.string(); };
        std::vector<Point> positions;
        MetricRows metrics(where, matrix_rows);
        for (const auto& [tag, row] : data.rows) {
            const std::vector<Point> places = places_of(kind, tag);
            if (places.empty()) refuse_at(path, "data for {} {}, which is not there", what, tag);
            const std::size_t values = row.size() / data.components;
            if (values > places.size()) {
                refuse_at(path, "{} values for element {}, which has {} nodes", values, tag,
                          places.size());
            }
            for (std::size_t i = 0; i < values; ++i) {
                require_coordinates(places[i], what, tag, where);
                positions.push_back(places[i]);
                metrics.add(std::span(row).subspan(i * data.components, data.components));
            }
        }
        std::vector<PointSource> sources = sources_from(positions, metrics.take());
        if (kind == at_corners) drop_repeated(sources);
        return sources;
    }

private:
    /// The first kind that has data, of the requested name if there is one.
    std::size_t chosen_kind() const {
        std::size_t first = kinds.size();
        for (std::size_t kind = kinds.size(); kind-- > 0;) {
            if (views_[kind].empty()) continue;
            if (first == kinds.size() || options_.array.empty() ||
                views_[kind].contains(options_.array)) {
                first = kind;
            }
        }
        if (first < kinds.size()) return first;
        refuse_at(file_.path(),
                  "no $NodeData, $ElementData or $ElementNodeData: save a view with the mesh");
    }

    std::vector<std::string> all_names() const {
        std::set<std::string> names;
        for (const Views& views : views_) {
            for (const auto& [name, data] : views) names.insert(name);
        }
        return {names.begin(), names.end()};
    }

    /// Of the data at a node, or of an element; none where that is not there.
    std::vector<Point> places_of(std::size_t kind, std::uint64_t tag) const {
        if (kind == at_nodes) {
            const auto node = nodes_.find(tag);
            return node == nodes_.end() ? std::vector<Point>() : std::vector{node->second};
        }
        const auto element = corners_.find(tag);
        if (element == corners_.end()) return {};
        if (kind == at_corners) return element->second;
        Point sum = Point::Zero();
        for (const Point& corner : element->second) sum += corner;
        return {sum / static_cast<double>(element->second.size())};
    }

    void read_format() {
        if (!file_.rest().starts_with("$MeshFormat")) file_.fail("does not start with $MeshFormat");
        file_.line();
        const std::string_view version = file_.word(), type = file_.word();
        is_old_ = version == "2" || version.starts_with("2.");
        if (version != "4.1" && !is_old_) {
            file_.fail("format {}: only 4.1 and 2.2 can be read, save it as one of them",
                       quote(version));
        }
        if (file_.word() != "8") file_.fail("numbers of another size than 8: save it here");
        if (type != "1") return;
        file_.line();
        is_binary_ = true;
        file_.set_binary(true);
        if (file_.number<std::int32_t>("the byte order") != 1) {
            file_.fail("another byte order: save it here");
        }
    }

    /// Goes behind the next line "$Section".
    bool find_section() {
        while (true) {
            file_.go_to(file_.at() - 1);  // the line may begin here
            const std::size_t found = file_.rest().find("\n$");
            if (found == std::string_view::npos) return false;
            file_.go_to(file_.at() + found + 2);
            file_.set_binary(false);
            section_ = file_.line();
            section_.erase(section_.find_last_not_of(Scanner::blanks) + 1);
            if (!section_.starts_with("End")) return true;
        }
    }

    std::uint64_t count() { return file_.number<std::uint64_t>(section_); }

    /// The numbers of blocks, and of nodes or elements of `least` bytes or more, at the beginning
    /// of a section.
    std::pair<std::uint64_t, std::uint64_t> read_counts(std::size_t least) {
        file_.set_binary(is_binary_);
        const std::uint64_t blocks = count(), all = count();
        file_.require_room(section_, all, least);
        count();  // smallest tag
        count();  // largest tag
        return {blocks, all};
    }

    void read_nodes() {
        auto [blocks, left] = read_counts(8);  // a tag and three coordinates, in text
        nodes_.reserve(nodes_.size() + left);
        for (std::uint64_t block = 0; block < blocks; ++block) {
            const auto dimension = file_.number<std::int32_t>("a block");
            file_.number<std::int32_t>("a block");  // the entity
            const bool parametric = file_.number<std::int32_t>("a block") != 0;
            const auto n = count();
            if (n > left) file_.fail("a block of {}, but {} are left", n, left);
            left -= n;
            std::vector<std::uint64_t> tags(n);
            for (auto& tag : tags) tag = count();
            for (const auto tag : tags) {
                Point x;
                for (double& c : x) c = file_.number<double>("a node");
                for (int u = 0; parametric && u < dimension; ++u) file_.number<double>("a node");
                nodes_.emplace(tag, x);
            }
        }
        if (left > 0) file_.fail("{} are in no block: {} left", section_, left);
    }

    void read_old_nodes() {
        std::uint64_t left = read_old_count(8);
        nodes_.reserve(nodes_.size() + left);
        for (; left > 0; --left) {
            const auto tag = static_cast<std::uint64_t>(file_.number<std::int32_t>("a node"));
            Point x;
            for (double& c : x) c = file_.number<double>("a node");
            nodes_.emplace(tag, x);
        }
    }

    /// The count of a section of format 2, a text also where the rest is not.
    std::uint64_t read_old_count(std::size_t least) {
        const std::uint64_t rows = count();
        file_.line();
        file_.set_binary(is_binary_);
        file_.require_room(section_, rows, least);
        return rows;
    }

    /// The corners of the elements that have data.
    void read_elements(const View& data) {
        if (elements_at_ == 0) file_.fail("data of elements, but no $Elements: save them too");
        file_.set_binary(false);
        file_.go_to(elements_at_);
        section_ = "Elements";
        constexpr std::size_t least = 4;  // a tag and a node, in text
        if (is_old_) return read_old_elements(data, read_old_count(least));
        const std::uint64_t blocks = read_counts(least).first;
        for (std::uint64_t block = 0; block < blocks; ++block) {
            file_.number<std::int32_t>("a block");  // dimension
            file_.number<std::int32_t>("a block");  // the entity
            const std::size_t nodes = read_type();
            const auto n = count();
            file_.require_room(section_, n, least);
            for (std::uint64_t i = 0; i < n; ++i) {
                const auto tag = count();
                read_corners(data, tag, nodes, [&] { return count(); });
            }
        }
    }

    /// In blocks where they are binary, each with its own head otherwise.
    void read_old_elements(const View& data, std::uint64_t left) {
        const auto number = [&] {
            return static_cast<std::uint64_t>(file_.number<std::int32_t>("an element"));
        };
        while (left > 0) {
            std::uint64_t tag = is_binary_ ? 0 : number();
            const std::size_t nodes = read_type();
            const std::uint64_t block = is_binary_ ? number() : 1;
            const std::uint64_t labels = number();
            if (block == 0 || block > left) {
                file_.fail("a block of {}, but {} are left", block, left);
            }
            file_.require_room(section_, labels, 1);
            left -= block;
            for (std::uint64_t i = 0; i < block; ++i) {
                if (is_binary_) tag = number();
                for (std::uint64_t label = 0; label < labels; ++label) number();
                read_corners(data, tag, nodes, number);
            }
        }
    }

    /// The number of nodes of the type of element that comes next.
    std::size_t read_type() {
        const auto type = file_.number<std::int32_t>("a block");
        const std::size_t nodes = nodes_of_element(type);
        if (nodes == 0) file_.fail("elements of the unknown type {}: save it without them", type);
        return nodes;
    }

    /// The nodes of an element, which `next_node` reads.
    void read_corners(const View& data, std::uint64_t tag, std::size_t nodes,
                      const std::function<std::uint64_t()>& next_node) {
        const bool is_needed = data.rows.contains(tag);
        std::vector<Point> corners;
        for (std::size_t k = 0; k < nodes; ++k) {
            const auto node = nodes_.find(next_node());
            if (!is_needed) continue;
            if (node == nodes_.end()) file_.fail("element {} has a node that is not there", tag);
            corners.push_back(node->second);
        }
        if (is_needed) corners_.emplace(tag, std::move(corners));
    }

    void read_data(std::size_t kind) {
        const auto count = [&] {
            const auto n = file_.number<std::uint64_t>(section_);
            file_.require_room(section_, n, 1);
            return n;
        };
        std::vector<std::string> texts(count());
        file_.line();
        for (std::string& text : texts) text = file_.line();
        for (std::uint64_t reals = count(); reals > 0; --reals) file_.number<double>(section_);
        std::vector<std::uint64_t> numbers(count());
        for (auto& number : numbers) number = file_.number<std::uint64_t>(section_);
        file_.line();
        if (texts.empty() || numbers.size() < 3) {
            file_.fail("a name, a step, components and a count expected");
        }
        const std::uint64_t step = numbers[0], components = numbers[1], rows = numbers[2];
        file_.require_room(section_, rows, is_binary_ ? 12 : 2);
        const std::size_t begin = texts[0].find('"') + 1;
        const std::string name = texts[0].substr(begin, texts[0].rfind('"') - begin);
        View& view = views_[kind][name];
        view.steps.insert(step);
        if (step != options_.step.value_or(step) || step < view.step) return;
        if (step > view.step || view.components == 0) {
            view.step = step;
            view.components = components;
            view.rows.clear();
        }
        file_.set_binary(is_binary_);
        for (std::uint64_t i = 0; i < rows; ++i) {
            const auto tag = static_cast<std::uint64_t>(file_.number<std::int32_t>(section_));
            std::uint64_t values = components;
            if (kind == at_corners) {
                const auto corners = file_.number<std::int32_t>(section_);
                if (corners < 1) file_.fail("element {} has {} corners", tag, corners);
                values *= static_cast<std::uint64_t>(corners);
                file_.require_room(section_, values, is_binary_ ? sizeof(double) : 2);
            }
            std::vector<double>& row = view.rows[tag];
            if (!row.empty()) file_.fail("{} {} has two values", kinds[kind].row, tag);
            for (std::uint64_t c = 0; c < values; ++c) {
                row.push_back(file_.number<double>(section_));
            }
        }
    }

    Scanner file_;
    const ReadOptions& options_;
    bool is_old_ = false;  ///< format 2
    bool is_binary_ = false;
    std::string section_;
    std::unordered_map<std::uint64_t, Point> nodes_;
    std::unordered_map<std::uint64_t, std::vector<Point>> corners_;  ///< of elements
    std::size_t elements_at_ = 0;  ///< where they begin; 0: nowhere
    std::array<Views, kinds.size()> views_;
};

}  // namespace

std::vector<PointSource> parse_msh_sources(std::string_view bytes,
                                           const std::filesystem::path& path,
                                           const ReadOptions& options) {
    return Parser(bytes, path, options).sources();
}

std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    return parse_msh_sources(read_binary_file(path), path, options);
}

}  // namespace controlspace

#include "io/text/msh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Data of one name.
struct View {
    std::uint64_t step;
    std::uint64_t components;
    std::map<std::uint64_t, std::vector<double>> rows;  ///< by node or element
};
using Views = std::map<std::string, View>;

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
    Parser(std::string_view bytes, const std::filesystem::path& path) : file_(bytes, path) {
        read_format();
        while (find_section()) {
            if (section_ == "Nodes") read_nodes();
            if (section_ == "Elements") elements_at_ = file_.at();
            if (section_ == "NodeData") read_data(of_nodes_);
            if (section_ == "ElementData") read_data(of_elements_);
            const std::size_t end = file_.rest().find("$End" + section_);
            file_.go_to(file_.at() + std::min(end, file_.rest().size()));
        }
    }

    std::vector<PointSource> sources(const std::string& view) {
        const std::filesystem::path& path = file_.path();
        if (of_nodes_.empty() && of_elements_.empty()) {
            refuse_at(path, "no $NodeData or $ElementData: save a view with the mesh");
        }
        const bool at_nodes = view.empty()
                                  ? !of_nodes_.empty()
                                  : of_nodes_.contains(view) || !of_elements_.contains(view);
        std::vector<std::string> names;
        for (const auto& [name, data] : at_nodes ? of_nodes_ : of_elements_) names.push_back(name);
        if (at_nodes && !view.empty()) {
            for (const auto& [name, data] : of_elements_) {
                if (!of_nodes_.contains(name)) names.push_back(name);
            }
        }
        const std::string& chosen = names[chosen_array(path, "views", names, view)];
        const View& data = (at_nodes ? of_nodes_ : of_elements_).at(chosen);
        if (data.components != 1 && data.components != matrix_rows.numbers) {
            refuse_at(path, "{} components: give 1 (sizes) or 9 (tensors)", data.components);
        }
        const char* what = at_nodes ? "node" : "element";
        if (data.rows.empty()) refuse_at(path, "no data at any {}: nothing to read", what);
        if (!at_nodes) read_elements(data);
        const auto& places = at_nodes ? nodes_ : centres_;
        const auto where = [&] { return path.string(); };
        std::vector<Point> positions;
        MetricRows metrics(where, matrix_rows);
        for (const auto& [tag, row] : data.rows) {
            const auto position = places.find(tag);
            if (position == places.end()) {
                refuse_at(path, "data for {} {}, which is not there", what, tag);
            }
            require_coordinates(position->second, what, tag, where);
            positions.push_back(position->second);
            metrics.add(row);
        }
        return sources_from(positions, metrics.take());
    }

private:
    void read_format() {
        if (!file_.rest().starts_with("$MeshFormat")) file_.fail("does not start with $MeshFormat");
        file_.line();
        const std::string_view version = file_.word(), type = file_.word();
        if (version != "4.1") {
            file_.fail("format {}: only 4.1 can be read, save it as that", quote(version));
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

    /// The centres of the elements that have data: means of their nodes.
    void read_elements(const View& data) {
        if (elements_at_ == 0) file_.fail("data of elements, but no $Elements: save them too");
        file_.go_to(elements_at_);
        section_ = "Elements";
        constexpr std::size_t least = 4;  // a tag and a node, in text
        const std::uint64_t blocks = read_counts(least).first;
        for (std::uint64_t block = 0; block < blocks; ++block) {
            file_.number<std::int32_t>("a block");  // dimension
            file_.number<std::int32_t>("a block");  // the entity
            const auto type = file_.number<std::int32_t>("a block");
            const std::size_t nodes = nodes_of_element(type);
            if (nodes == 0) {
                file_.fail("elements of the unknown type {}: save it without them", type);
            }
            const auto n = count();
            file_.require_room(section_, n, least);
            for (std::uint64_t i = 0; i < n; ++i) {
                const auto tag = count();
                const bool is_needed = data.rows.contains(tag);
                Point sum = Point::Zero();
                for (std::size_t k = 0; k < nodes; ++k) {
                    const auto node = nodes_.find(count());
                    if (!is_needed) continue;
                    if (node == nodes_.end()) {
                        file_.fail("element {} has a node that is not there", tag);
                    }
                    sum += node->second;
                }
                if (is_needed) centres_.emplace(tag, sum / static_cast<double>(nodes));
            }
        }
    }

    void read_data(Views& views) {
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
        View& view = views.try_emplace(name, View{step, components, {}}).first->second;
        if (step > view.step) return;
        if (step < view.step) view = {step, components, {}};
        file_.set_binary(is_binary_);
        for (std::uint64_t i = 0; i < rows; ++i) {
            const auto tag = static_cast<std::uint64_t>(file_.number<std::int32_t>(section_));
            std::vector<double>& row = view.rows[tag];
            if (!row.empty()) {
                const char* what = &views == &of_nodes_ ? "node" : "element";
                file_.fail("{} {} has two values", what, tag);
            }
            for (std::uint64_t c = 0; c < components; ++c) {
                row.push_back(file_.number<double>(section_));
            }
        }
    }

    Scanner file_;
    bool is_binary_ = false;
    std::string section_;
    std::unordered_map<std::uint64_t, Point> nodes_;
    std::unordered_map<std::uint64_t, Point> centres_;  ///< of elements
    std::size_t elements_at_ = 0;                       ///< where they begin; 0: nowhere
    Views of_nodes_, of_elements_;
};

}  // namespace

std::vector<PointSource> parse_msh_sources(std::string_view bytes,
                                           const std::filesystem::path& path,
                                           const std::string& view) {
    return Parser(bytes, path).sources(view);
}

std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const std::string& view) {
    return parse_msh_sources(read_binary_file(path), path, view);
}

}  // namespace controlspace

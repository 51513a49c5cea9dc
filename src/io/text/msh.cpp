#include "io/text/msh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "controlspace/error.h"
#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"

namespace controlspace {
namespace {

/// Data of one name.
struct View {
    std::uint64_t step;
    std::uint64_t components;
    std::map<std::uint64_t, std::vector<double>> rows;  ///< by node
};

/// Reads a file section by section; passes over all but nodes and their data.
class Parser {
public:
    Parser(std::string_view bytes, const std::filesystem::path& path) : file_(bytes, path) {
        read_format();
        while (find_section()) {
            if (section_ == "Nodes") read_nodes();
            if (section_ == "NodeData") read_data();
            const std::size_t end = file_.rest().find("$End" + section_);
            file_.go_to(file_.at() + std::min(end, file_.rest().size()));
        }
    }

    std::vector<PointSource> sources(const std::string& view) const {
        const std::filesystem::path& path = file_.path();
        const auto fail = [&](const std::string& what) {
            throw InputError(fmt::format("{}: {}", path.string(), what));
        };
        if (views_.empty()) fail("no $NodeData: save a view with the mesh");
        std::vector<std::string> names;
        for (const auto& [name, data] : views_) names.push_back(name);
        const View& data = views_.at(names[chosen_array(path, "views", names, view)]);
        if (data.components != 1 && data.components != matrix_rows.numbers) {
            fail(fmt::format("{} components: give 1 (sizes) or 9 (tensors)", data.components));
        }
        if (data.rows.empty()) fail("no data at any node: nothing to read");
        const auto where = [&] { return path.string(); };
        std::vector<Point> positions;
        MetricRows metrics(where, matrix_rows);
        for (const auto& [node, row] : data.rows) {
            const auto position = nodes_.find(node);
            if (position == nodes_.end()) {
                fail(fmt::format("data for node {}, which is not there", node));
            }
            require_coordinates(position->second, "node", node, where);
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
            file_.fail(
                fmt::format("format {}: only 4.1 can be read, save it as that", quote(version)));
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

    void read_nodes() {
        file_.set_binary(is_binary_);
        const auto count = [&] { return file_.number<std::uint64_t>(section_); };
        const std::uint64_t blocks = count();
        std::uint64_t left = count();
        constexpr std::size_t least = 8;  // a tag and three coordinates, in text
        file_.require_room(section_, left, least);
        nodes_.reserve(nodes_.size() + left);
        count();  // smallest tag
        count();  // largest tag
        for (std::uint64_t block = 0; block < blocks; ++block) {
            const auto dimension = file_.number<std::int32_t>("a block");
            file_.number<std::int32_t>("a block");  // the entity
            const bool parametric = file_.number<std::int32_t>("a block") != 0;
            const auto n = count();
            if (n > left) file_.fail(fmt::format("a block of {}, but {} are left", n, left));
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
        if (left > 0) file_.fail(fmt::format("{} are in no block: {} left", section_, left));
    }

    void read_data() {
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
        View& view = views_.try_emplace(name, View{step, components, {}}).first->second;
        if (step > view.step) return;
        if (step < view.step) view = {step, components, {}};
        file_.set_binary(is_binary_);
        for (std::uint64_t i = 0; i < rows; ++i) {
            const auto node = static_cast<std::uint64_t>(file_.number<std::int32_t>("a node"));
            std::vector<double>& row = view.rows[node];
            if (!row.empty()) file_.fail(fmt::format("node {} has two values", node));
            for (std::uint64_t c = 0; c < components; ++c) {
                row.push_back(file_.number<double>("data of a node"));
            }
        }
    }

    Scanner file_;
    bool is_binary_ = false;
    std::string section_;
    std::unordered_map<std::uint64_t, Point> nodes_;
    std::map<std::string, View> views_;
};

}  // namespace

std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const std::string& view) {
    const std::string bytes = read_binary_file(path);
    return Parser(bytes, path).sources(view);
}

}  // namespace controlspace

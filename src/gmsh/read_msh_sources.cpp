#include "gmsh/read_msh_sources.h"

#include <fmt/format.h>
#include <gmsh.h>

#include <array>
#include <unordered_map>

#include "controlspace/error.h"
#include "gmsh/gmsh_session.h"
#include "gmsh/msh_counts.h"
#include "io/text/metric_rows.h"
#include "io/text/text_file.h"

namespace controlspace {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
}

/// Tag of the view of that name, or of the only one.
int chosen_view(const std::filesystem::path& path, const std::string& name) {
    std::vector<int> tags;
    gmsh::view::getTags(tags);
    std::string names;
    std::vector<int> chosen;
    for (const int tag : tags) {
        const int index = gmsh::view::getIndex(tag);
        std::string its_name;
        gmsh::option::getString(fmt::format("View[{}].Name", index), its_name);
        names += (names.empty() ? "" : ", ") + quote(its_name);
        if (name.empty() || its_name == name) chosen.push_back(tag);
    }
    if (tags.empty()) fail(path, "no $NodeData: save a view with the mesh");
    if (chosen.size() == 1) return chosen.front();
    fail(path, fmt::format("{} of its views can be meant: name one of {} (--source-array)",
                           chosen.size(), names));
}

using Places = std::unordered_map<std::size_t, Point>;

Places places_of_nodes() {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates, parameters;
    gmsh::model::mesh::getNodes(tags, coordinates, parameters);
    Places places;
    for (std::size_t i = 0; i < tags.size(); ++i) places.emplace(tags[i], &coordinates[3 * i]);
    return places;
}

}  // namespace

std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const std::string& view) {
    require_plausible_msh(read_binary_file(path), path);
    return in_gmsh_session(1, [&] {
        gmsh::merge(path.string());
        std::string type;
        std::vector<std::size_t> tags;
        std::vector<std::vector<double>> rows;
        double time = 0;
        int components = 0;
        constexpr int first_step = 0;
        gmsh::view::getModelData(chosen_view(path, view), first_step, type, tags, rows, time,
                                 components);
        if (type != "NodeData") fail(path, fmt::format("{}: give $NodeData", quote(type)));
        constexpr int tensor = 9;
        if (components != 1 && components != tensor) {
            fail(path, fmt::format("{} components: give 1 (sizes) or 9 (tensors)", components));
        }
        const Places places = places_of_nodes();
        MetricRows metrics(path, "by rows");
        std::vector<PointSource> sources;
        for (std::size_t i = 0; i < tags.size(); ++i) {
            const auto place = places.find(tags[i]);
            if (place == places.end())
                fail(path, fmt::format("data for node {}, which is not there", tags[i]));
            for (const double x : place->second) {
                if (!is_coordinate(x)) {
                    fail(path, fmt::format("node {} has a coordinate {}", tags[i], x));
                }
            }
            if (rows[i].size() != static_cast<std::size_t>(components)) {
                fail(path, fmt::format("{} numbers for node {}", rows[i].size(), tags[i]));
            }
            sources.push_back({place->second, {}});
            if (components == 1) {
                metrics.add_size(rows[i].front());
            } else {
                std::array<double, tensor> t;
                std::copy(rows[i].begin(), rows[i].end(), t.begin());
                metrics.add_matrix(t);
            }
        }
        if (sources.empty()) fail(path, "no data at any node: nothing to read");
        const std::vector<Metric> all = metrics.take();
        for (std::size_t i = 0; i < sources.size(); ++i) sources[i].metric = all[i];
        return sources;
    });
}

}  // namespace controlspace

// Data flows one way: no folder includes from one to its right.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "data_folder.h"

namespace fs = std::filesystem;

namespace {

// Folders with the same number know nothing of each other.
const std::map<std::string, int> layers{
    {"geometry", 0}, {"metric", 1}, {"sources", 2}, {"gradation", 2}, {"cones", 3},   {"space", 4},
    {"fields", 4},   {"io", 5},     {"trees", 5},   {"baselines", 6}, {"measure", 6}, {"mesh", 7},
    {"gmsh", 8},     {"study", 9},  {"c", 9},       {"cli", 10}};

bool is_source(const fs::path& path) {
    return path.extension() == ".h" || path.extension() == ".cpp";
}

}  // namespace

TEST_CASE("no folder includes from one to its right") {
    const fs::path root = data_folder().parent_path();
    const std::regex include("^#include \"([a-z]+)/.*");
    int includes = 0;
    for (const auto& [folder, layer] : layers) {
        const fs::path place = folder == "baselines" ? root / folder : root / "src" / folder;
        for (const auto& file : fs::recursive_directory_iterator(place)) {
            if (!is_source(file.path())) continue;
            std::ifstream text(file.path());
            for (std::string line; std::getline(text, line);) {
                std::smatch match;
                if (!std::regex_match(line, match, include)) continue;
                const std::string& from = match[1];
                CAPTURE(file.path().string(), line);
                REQUIRE(layers.count(from) == 1);
                CHECK((from == folder || layers.at(from) < layer));
                ++includes;
            }
        }
    }
    CHECK(includes > 100);
}

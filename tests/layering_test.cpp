// SPDX-License-Identifier: Apache-2.0
// Dependencies point one way: no folder includes from one to its right, and public headers include
// only each other.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "data_folder.h"

namespace fs = std::filesystem;

namespace {

// Folders with the same number know nothing of each other.
const std::map<std::string, int> layers{
    {"files", 0},    {"geometry", 0}, {"metric", 1}, {"sources", 2}, {"gradation", 2},
    {"cones", 3},    {"space", 4},    {"fields", 5}, {"io", 6},      {"trees", 6},
    {"measure", 7},  {"mesh", 8},     {"gmsh", 9},   {"study", 10},  {"baselines", 7},
    {"modules", 10}, {"c", 10},       {"cli", 11},   {"mpi", 12},    {"cuda", 12}};

struct Include {
    fs::path file;
    std::string line, target;
    bool is_public;  // of a public header
};

const std::regex quoted("^#include \"([^\"]+)\".*"), in_brackets("^#include <([^>]+)>.*");

// Of the sources below a folder; includes of the compiler's and of libraries' headers are in
// brackets.
std::vector<Include> includes_in(const fs::path& folder, const std::regex& form = quoted) {
    std::vector<Include> includes;
    if (!fs::exists(folder)) return includes;
    for (const auto& file : fs::recursive_directory_iterator(folder)) {
        if (file.path().extension() != ".h" && file.path().extension() != ".cpp") continue;
        std::ifstream text(file.path());
        for (std::string line; std::getline(text, line);) {
            std::smatch match;
            if (!std::regex_match(line, match, form)) continue;
            std::string target = match[1];
            const bool is_public = target.starts_with("controlspace/");
            if (is_public) target.erase(0, sizeof "controlspace/" - 1);
            includes.push_back({file.path(), line, target, is_public});
        }
    }
    return includes;
}

// The first folder of a path; empty for the headers that lie beside the folders.
std::string first_folder(const std::string& path) {
    const std::size_t slash = path.find('/');
    return slash == std::string::npos ? "" : path.substr(0, slash);
}

}  // namespace

TEST_CASE("no folder includes from one to its right") {
    const fs::path root = data_folder().parent_path();
    int seen = 0;
    for (const auto& [folder, layer] : layers) {
        const fs::path place = folder == "baselines" ? root / folder : root / "src" / folder;
        for (const fs::path& part : {place, root / "src/include/controlspace" / folder}) {
            for (const Include& include : includes_in(part)) {
                const std::string from = first_folder(include.target);
                if (from.empty()) continue;
                CAPTURE(include.file.string(), include.line);
                if (layers.count(from) == 0) {
                    FAIL_CHECK("a folder that has no layer");
                    continue;
                }
                CHECK((from == folder || layers.at(from) < layer));
                ++seen;
            }
        }
    }
    CHECK(seen > 300);
}

TEST_CASE("public headers include public headers alone, and are what users call") {
    const fs::path headers = data_folder().parent_path() / "src/include/controlspace";
    for (const auto& entry : fs::recursive_directory_iterator(headers)) {
        CHECK(entry.path().filename() != "detail");
    }
    const std::vector<Include> includes = includes_in(headers);
    for (const Include& include : includes) {
        CAPTURE(include.file.string(), include.line);
        CHECK(include.is_public);
        CHECK(fs::exists(headers / include.target));
    }
    CHECK(includes.size() > 30);
}

TEST_CASE("spdlog, CLI11, JSON and TOML are of studies and programs alone") {
    const fs::path root = data_folder().parent_path();
    int seen = 0;
    for (const auto& [folder, layer] : layers) {
        const fs::path place = folder == "baselines" ? root / folder : root / "src" / folder;
        const bool may_include = folder == "study" || folder == "cli" || folder == "mpi";
        for (const fs::path& part : {place, root / "src/include/controlspace" / folder}) {
            for (const Include& include : includes_in(part, in_brackets)) {
                const std::string library = first_folder(include.target);
                if (library != "spdlog" && library != "CLI" && library != "nlohmann" &&
                    library != "toml++") {
                    continue;
                }
                CAPTURE(include.file.string(), include.line);
                CHECK((may_include && part == place));
                ++seen;
            }
        }
    }
    CHECK(seen > 10);
}

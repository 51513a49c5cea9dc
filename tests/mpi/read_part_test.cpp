// SPDX-License-Identifier: Apache-2.0
#include "mpi/read_part.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"

namespace controlspace::read_part_test {
namespace {

struct TextFile {
    explicit TextFile(const std::string& text)
        : path(std::filesystem::temp_directory_path() /
               ("controlspace-part-" + std::to_string(::getpid()) + ".csv")) {
        std::ofstream(path, std::ios::binary) << text;
    }
    ~TextFile() { std::filesystem::remove(path); }
    std::filesystem::path path;
};

}  // namespace

TEST_CASE("parts of a table make the whole") {
    const std::string rows = "1,2,3,0.5\n-4,5.25,6e3,0.125\r\n\n# words\n7,8,9,1\n10,11,12,2";
    for (const std::string& text :
         {"x,y,z,h\n" + rows, "# first\n\nx,y,z,h\r\n" + rows + "\n# last\n",
          std::string("x,y,z,h,g\n1,2,3,4,1.5\n")}) {
        const TextFile file(text);
        const std::vector<PointSource> whole = read_sources(file.path);
        for (int parts = 1; parts < 90; ++parts) {
            CAPTURE(text, parts);
            std::vector<PointSource> joined;
            for (int part = 0; part < parts; ++part) {
                const auto some = read_csv_part(file.path, part, parts);
                joined.insert(joined.end(), some.begin(), some.end());
            }
            CHECK(joined == whole);
        }
    }
}

TEST_CASE("a bad line of a part is named by its number in the file") {
    std::string text = "x,y,z,h\n";
    for (int i = 0; i < 100; ++i) text += i == 80 ? "1,2,x,4\n" : "1,2,3,4\n";
    const TextFile file(text);
    CHECK_THROWS_WITH(read_csv_part(file.path, 3, 4), Catch::Contains(":82: z = 'x'"));
    CHECK(read_csv_part(file.path, 0, 4).size() == 25);
    const TextFile empty("x,y,z,h\n");
    CHECK_THROWS_AS(read_csv_part(empty.path, 0, 2), InputError);
}

}  // namespace controlspace::read_part_test

// End to end: files of every format that cannot be read, each with its reason and its place.
#include <catch2/catch.hpp>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "app/sandbox.h"
#include "sources/medit_bytes.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// A file, and what is said of it.
struct BadFile {
    std::string name, content, expected;
};

const std::string byte_order_mark = "\xEF\xBB\xBF";
const std::string medit_head = "MeshVersionFormatted 2\nDimension 3\n";

/// A good mesh of one vertex, for solutions to lie beside.
const std::string mesh = medit_head + "Vertices\n1\n0 0 0 0\nEnd\n";

std::string solb(std::initializer_list<double> tensor, std::int64_t count = 1) {
    MeditBytes file(2);
    file.block(62, 12 + 8 * tensor.size()).integer(count).word(1).word(tensor.size() == 1 ? 1 : 3);
    for (const double x : tensor) file.real(x);
    return file.end().bytes();
}

std::vector<BadFile> csv_files() {
    const std::string head = "x,y,z,h\n";
    return {
        {"f.csv", "", "f.csv is empty"},
        {"f.csv", byte_order_mark, "f.csv is empty"},
        {"f.csv", head, "holds no sources"},
        {"f.csv", head + "0,0,0,1\n0,0,", "f.csv:3: 3 columns instead of 4"},
        {"f.csv", head + "0,0,zero,1\n", "f.csv:2: z = 'zero' is not a number"},
        {"f.csv", head + "0,0,0,nan\n", "f.csv:2: h = nan"},
        {"f.csv", head + "0,inf,0,1\n", "f.csv:2: y = inf"},
        {"f.csv", head + "0,0,0,-1\n", "f.csv:2: h = -1: a length must be positive"},
        {"f.csv", "x,y,h\n0,0,1\n", "f.csv:1: column 'z' is missing"},
        {"f.csv", "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,1,1,1,2,0,0\n",
         "f.csv:2: tensor (1 1 1 2 0 0) is not positive definite"},
        {"f.csv", head + std::string("0,0,0,\0", 7), "holds a zero byte"},
    };
}

std::vector<BadFile> medit_files() {
    const std::string head = medit_head + "SolAtVertices\n";
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {
        {"f.sol", "", "f.sol is empty"},
        {"f.sol", "f,g\n", "f.sol:1: does not start with MeshVersionFormatted"},
        {"f.sol", head + "1\n1 3\n1 0 1 0 0", "f.sol:6: the file ends within tensor 1"},
        {"f.sol", head + "1\n1 1\nsmall\n", "f.sol:6: size 1: 'small' is not a number"},
        {"f.sol", head + "2000000000\n1 1\n1\n", "f.sol:4: SolAtVertices 2000000000"},
        {"f.sol", head + "-1\n1 1\n1\n", "f.sol:4: SolAtVertices is followed by '-1'"},
        {"f.sol", head + "1\n1 1\nnan\n", "f.sol:6: size 1 has nan"},
        {"f.sol", head + "1\n1 3\n1 2 1 0 0 1\n",
         "tensor 1 of f.sol is not positive definite, 1 of 1 are not: is the order of their "
         "components xx xy yy xz yz zz?"},
        {"f.sol", "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n1\n1 1\n1\n",
         "f.sol:2: Dimension is 2"},
        {"f.sol", head + "2\n1 1\n1 1\n", "f.mesh has 1 vertices, and f.sol has sizes for 2"},
        {"f.solb", "", "f.solb is empty"},
        {"f.solb", solb({1}).substr(0, 40), "f.solb, byte "},
        {"f.solb", "solution of numbers\n", "f.solb:1: does not start with"},
        {"f.solb", solb({1}, 2'000'000'000), "SolAtVertices 2000000000, but the file can hold"},
        {"f.solb", solb({1}, -1), "SolAtVertices -1: nothing to read"},
        {"f.solb", solb({nan}), "size 1 has nan"},
        {"f.solb", solb({1, 2, 1, 0, 0, 1}), "tensor 1 of f.solb is not positive definite"},
    };
}

}  // namespace

TEST_CASE("a file that cannot be read is refused in one line that names the place") {
    const auto files = GENERATE(csv_files, medit_files);
    for (const BadFile& file : files()) {
        const Sandbox box("bad-input");
        box.write("f.mesh", mesh);
        box.write(file.name, file.content);
        INFO(file.name << ": " << file.content);
        check_refused(box.run("info " + file.name), file.expected);
    }
}

TEST_CASE("a folder is no file of sources, whatever it is called") {
    const std::string ending = GENERATE("csv", "mesh", "meshb", "sol", "solb");
    const Sandbox box("bad-folder");
    fs::create_directory(box / ("f." + ending));
    check_refused(box.run("info f." + ending), "f." + ending + " is a directory");
}

TEST_CASE("a byte order mark and the line ends of Windows are passed over") {
    const Sandbox box("windows");
    box.write("f.csv", byte_order_mark + "x,y,z,h\r\n0,0,0,1\r\n1,0,0,2\r\n");
    box.write("f.mesh", byte_order_mark +
                            "MeshVersionFormatted 2\r\nDimension\r\n3\r\nVertices\r\n1\r\n"
                            "0 0 0 0\r\nEnd\r\n");
    box.write("f.sol", byte_order_mark +
                           "MeshVersionFormatted 2\r\nDimension 3\r\nSolAtVertices\r\n1\r\n1 1\r\n"
                           "2\r\nEnd\r\n");
    CHECK_THAT(box.run("info f.csv").out, Contains("1 to 2"));
    CHECK_THAT(box.run("info f.sol").out, Contains("2 to 2"));
}

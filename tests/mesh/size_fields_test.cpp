// SPDX-License-Identifier: Apache-2.0
// Lengths as Gmsh's own size fields give them: of a grid that was written, and of the program
// behind a pipe.
#include <gmsh.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "geometry/random_fractions.h"
#include "gmsh/gmsh_session.h"
#include "io/text/size_files.h"
#include "sources/files.h"

namespace controlspace::size_fields_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 2, 0.5)};

std::unique_ptr<ControlSpace> made() {
    const auto builder = find_entry(tree_catalogue(), "K_oV")
                             ->make({.domain = domain, .finest_length = 0.05, .ratio = 1.25});
    builder->insert(std::vector<PointSource>{{{0.31, 0.42, 0.13}, Metric::isotropic(0.05)},
                                             {{-0.7, 1.1, -0.6}, Metric::isotropic(0.1)}});
    builder->grade({.ratio = 1.25});
    return builder->build();
}

/// In and around the domain.
std::vector<Point> places() {
    RandomFractions random(5);
    std::vector<Point> x;
    for (int i = 0; i < 1000; ++i) {
        const double a = random(), b = random(), c = random();
        const Vector t = 1.04 * Vector(a, b, c) - Vector::Constant(0.02);
        x.push_back(domain.low + t.cwiseProduct(domain.edges()));
    }
    return x;
}

/// What a field of Gmsh gives at the places, by its plugin that shows fields.
std::vector<double> by_gmsh(const std::string& kind, const std::string& option,
                            const std::string& value) {
    std::vector<double> lengths;
    in_gmsh_session(1, [&] {
        const int field = gmsh::model::mesh::field::add(kind);
        gmsh::model::mesh::field::setString(field, option, value);
        if (kind == "Structured") {
            gmsh::model::mesh::field::setNumber(field, "TextFormat", 0);
            // Without a value of its own outside; 4.8.4 leaves that open.
            gmsh::model::mesh::field::setNumber(field, "SetOutsideValue", 0);
        }
        std::vector<double> data;
        for (const Point& x : places()) {
            data.insert(data.end(), x.begin(), x.end());
            data.push_back(0);
        }
        const int view = gmsh::view::add("places");
        gmsh::view::addListData(view, "SP", static_cast<int>(data.size() / 4), data);
        gmsh::plugin::setNumber("MeshSizeFieldView", "MeshSizeField", field);
        gmsh::plugin::setNumber("MeshSizeFieldView", "View", gmsh::view::getIndex(view));
        gmsh::plugin::run("MeshSizeFieldView");
        std::vector<std::string> types;
        std::vector<int> counts;
        std::vector<std::vector<double>> found;
        gmsh::view::getListData(view, types, counts, found);
        for (std::size_t i = 3; i < found.at(0).size(); i += 4) lengths.push_back(found[0][i]);
    });
    return lengths;
}

std::vector<double> by_structure(const ControlSpace& space) {
    const std::vector<Point> x = places();
    std::vector<double> lengths(x.size());
    space.sample_lengths(x, lengths);
    return lengths;
}

/// The largest factor between the two at 99 % of places.
double usual_factor(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    std::vector<double> factors;
    for (std::size_t i = 0; i < a.size(); ++i)
        factors.push_back(std::max(a[i] / b[i], b[i] / a[i]));
    std::ranges::sort(factors);
    return factors[factors.size() * 99 / 100 - 1];
}

}  // namespace

TEST_CASE("Gmsh's field Structured answers as the structure, within what its steps carry") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "f.structured";
    const auto space = made();
    const std::vector<double> expected = by_structure(*space);
    double last = 2;
    for (const int samples : {17, 33, 129}) {
        const SizeFile written = write_gmsh_structured(path, *space, samples);
        const double factor = usual_factor(by_gmsh("Structured", "FileName", path), expected);
        CAPTURE(samples, factor, *written.within);
        // The report is of other places.
        CHECK(factor < 1 + 1.2 * (*written.within - 1));
        CHECK(factor < last);
        last = factor;
    }
    CHECK(last < 1.04);  // steps of 0.023 where the smallest length is 0.05
}

TEST_CASE("Gmsh's field ExternalProcess gets the lengths of the structure, to the bit") {
    const ScratchDirectory folder;
    const auto space = made();
    save_control_space(folder.path() / "f.ctrl", *space);
    const std::string command =
        CONTROLSPACE_APP " query '" + (folder.path() / "f.ctrl").string() + "' --pipe";
    CHECK(by_gmsh("ExternalProcess", "CommandLine", command) == by_structure(*space));
}

}  // namespace controlspace::size_fields_test

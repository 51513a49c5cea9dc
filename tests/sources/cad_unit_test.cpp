// SPDX-License-Identifier: Apache-2.0
// The unit of length that CAD files say.
#include "io/text/cad_unit.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "sources/files.h"

namespace controlspace::cad_unit_test {
namespace {

std::string step(const std::string& entities) {
    return "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=POINT(0.);\n" + entities +
           "#9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\nENDSEC;\nEND-ISO-10303-21;\n";
}

/// A global section, cut into lines of 72 characters.
std::string iges(const std::string& global) {
    std::string text = fmt::format("{:72}S      1\n", "");
    for (std::size_t i = 0; i < global.size(); i += 72) {
        text += fmt::format("{:72}G      1\n", global.substr(i, 72));
    }
    return text + fmt::format("{:72}T      1\n", "");
}

}  // namespace

TEST_CASE("the unit of a STEP file is that of its lengths, however it is written") {
    const ScratchDirectory scratch;
    const auto [entities, unit] = GENERATE(table<std::string, std::string>({
        {"#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n", "mm"},
        {"#2 = ( LENGTH_UNIT() NAMED_UNIT(*)\n  SI_UNIT( $ ,\n.METRE.) );\n", "m"},
        {"#2=(NAMED_UNIT(*)SI_UNIT(.MICRO.,.METRE.)LENGTH_UNIT());\n", "um"},
        {"#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
         "#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#2);\n"
         "#4=(CONVERSION_BASED_UNIT('INCH',#3)LENGTH_UNIT()NAMED_UNIT(#5));\n",
         "in"},
        {"#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
         "#3=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n",
         "m and mm"},
        {"", ""},
    }));
    CAPTURE(entities);
    CHECK(cad_unit(scratch.file("part.STEP", step(entities))) == unit);
    CHECK(cad_unit(scratch.file("part.brep", step(entities))).empty());
}

TEST_CASE("the unit of an IGES file is the flag behind texts that may hold commas") {
    const ScratchDirectory scratch;
    const auto [separator, flag, unit] = GENERATE(table<char, std::string, std::string>(
        {{',', "2", "mm"}, {',', "1", "in"}, {'/', "6", "m"}, {',', "3", ""}, {',', "", ""}}));
    std::string global =
        "1H,,1H;,4Ha,b,,9Hpart,1.ig,40Hsome program, with, commas and a long name,"
        "7HVersion,32,38,6,308,15,4Hname,1.,@,2HMM,1,0.1;";
    global.replace(global.find('@'), 1, flag);
    if (separator == '/') {
        // Only those that separate.
        global = "1H//1H;/4Ha,b,/9Hpart,1.ig/3Ha/b/1Hv/32/38/6/308/15/4Hname/1./" + flag + "/1HM;";
    }
    CAPTURE(global);
    CHECK(cad_unit(scratch.file("part.igs", iges(global))) == unit);
    CHECK(cad_unit(scratch.file("part.igs", "no IGES")).empty());
}

}  // namespace controlspace::cad_unit_test

// SPDX-License-Identifier: Apache-2.0
#include "study/text_table.h"

#include <catch2/catch.hpp>

namespace controlspace::text_table_test {
namespace {

const TextTable table{
    "Title", "Note.", {{"name", Align::left}, {"ρ"}}, {{"a|b", "1.5"}, {"µ", "–"}}};

}  // namespace

TEST_CASE("terminal tables align by characters") {
    CHECK(render(table) ==
          "Title\nNote.\n"
          "name    ρ\n"
          "----  ---\n"
          "a|b   1.5\n"
          "µ       –\n");
}

TEST_CASE("line breaks do not break a table") {
    const TextTable broken{"T", "", {{"c", Align::left}}, {{"a\nb"}}};
    CHECK(render(broken) == "T\nc\n---\na b\n");
}

}  // namespace controlspace::text_table_test

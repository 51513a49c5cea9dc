// The page is well-formed, whatever it holds, and needs nothing else.
#include "report/html.h"

#include <catch2/catch.hpp>

#include "report/markup.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

const std::string hostile = "</td><script>alert(1)</script> & \"quoted\" ]]> \x01";

}  // namespace

TEST_CASE("the check of markup finds what is wrong") {
    CHECK(markup_fault("<p>a &amp; b<br /></p>").empty());
    for (const char* page : {"<p>", "</p>", "<p><b></p></b>", "<p>a & b</p>", "<p", "a < b"}) {
        CAPTURE(page);
        CHECK_FALSE(markup_fault(page).empty());
    }
}

TEST_CASE("texts of results stand in the page as texts") {
    Figure figure;
    figure.name = "name";
    figure.title = figure.caption = figure.made_by = hostile;
    TextTable table{hostile, hostile, {{hostile, Align::left}, {"n"}}, {{hostile, "1"}}};
    const std::string page =
        html_page(hostile, html_figure(figure, "<svg></svg>") + html_table(table));
    CHECK(markup_fault(page).empty());
    CHECK(page.find("<script>alert") == page.npos);
    CHECK(page.find('\x01') == page.npos);
    CHECK_THAT(page, Contains("&lt;script&gt;alert(1)"));
    CHECK(page.find("http") == page.npos);
}

TEST_CASE("pictures lie in the page in base64") {
    // The examples of RFC 4648, section 10.
    const std::pair<const char*, const char*> examples[] = {
        {"f", "Zg=="},        {"fo", "Zm8="},        {"foo", "Zm9v"},
        {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}};
    for (const auto& [bytes, text] : examples) {
        CHECK_THAT(html_figure({}, bytes), Contains(std::string("base64,") + text + '"'));
    }
}

TEST_CASE("a table has every cell, and heads to sort by") {
    const TextTable table{"t", "", {{"a", Align::left}, {"b"}}, {{"x", "1"}, {"y", "2"}}};
    const std::string text = html_table(table);
    CHECK_THAT(text, Contains("<td class=\"left\">x</td><td>1</td>"));
    CHECK_THAT(text, Contains("<td class=\"left\">y</td><td>2</td>"));
    CHECK_THAT(text, Contains("onclick=\"sort_by(this)\""));
}

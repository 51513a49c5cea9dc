// gnuplot as it is run, and what is handed to it.
#include "report/figure.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "scratch_directory.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

Figure line_figure() {
    return {.name = "line",
            .title = "A line",
            .caption = "",
            .made_by = "a command",
            .data = "$points << EOD\n1 2\n3 4\nEOD\n",
            .commands = "plot $points using 1:2 with lines notitle\n"};
}

}  // namespace

TEST_CASE("a figure is drawn as a whole SVG and PNG, beside its script") {
    const ScratchDirectory folder;
    Gnuplot().draw(line_figure(), folder.path());
    CHECK_THAT(file_bytes(folder.path() / "line.svg"), Contains("<svg") && Contains("</svg>"));
    CHECK(file_bytes(folder.path() / "line.png").substr(1, 3) == "PNG");
    CHECK(names_in(folder.path()) == std::vector<std::string>{"line.gp", "line.png", "line.svg"});
}

TEST_CASE("no text of a figure is a command to gnuplot or to the shell") {
    const ScratchDirectory folder;
    const std::string hostile =
        "`touch a` $(touch b) 'system(\"touch c\") \n!touch d\n\\n @m %s {/x}";
    Figure figure = line_figure();
    figure.title = figure.made_by = hostile;
    figure.data = "$points << EOD\n1 2 " + gnuplot_cell(hostile) + "\nEOD\n";
    figure.commands =
        "plot $points using 1:2:3 with labels title " + gnuplot_string(hostile) + "\n";
    Gnuplot().draw(figure, folder.path());
    CHECK(names_in(folder.path()) == std::vector<std::string>{"line.gp", "line.png", "line.svg"});
    CHECK_THAT(file_bytes(folder.path() / "line.svg"), Contains("`touch a`"));
}

TEST_CASE("a figure that gnuplot cannot draw, or not whole, is refused with its words") {
    const ScratchDirectory folder;
    Figure figure = line_figure();
    figure.commands = "plot $nothing\n";
    CHECK_THROWS_WITH(Gnuplot().draw(figure, folder.path()),
                      Contains("line.gp") && Contains("nothing"));
    figure.commands = "exit\n";  // without a picture, and without a word
    CHECK_THROWS_WITH(Gnuplot().draw(figure, folder.path()), Contains("is the disk full?"));
}

TEST_CASE("a folder that is full gives no picture") {
    const ScratchDirectory folder;
    std::filesystem::create_symlink("/dev/full", folder.path() / "line.svg");
    CHECK_THROWS_WITH(Gnuplot().draw(line_figure(), folder.path()), Contains("is the disk full?"));
}

TEST_CASE("without gnuplot in PATH the message names its package") {
    const std::string path = std::getenv("PATH");
    setenv("PATH", "/nowhere", 1);
    CHECK_THROWS_WITH(Gnuplot(), Contains("gnuplot-nox"));
    setenv("PATH", path.c_str(), 1);
}

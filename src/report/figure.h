#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace controlspace {

/// One picture, drawn by gnuplot, and the words that go with it.
struct Figure {
    std::string name;     ///< of its files, without ending
    std::string title;    ///< what is shown, of what
    std::string caption;  ///< how to read it; may be empty
    std::string made_by;  ///< the command that its numbers are from
    int width = 760;      ///< pixels
    int height = 520;
    bool raster = false;  ///< the page shows the PNG: the SVG would be larger
    std::string data;     ///< gnuplot's datablocks: the numbers, as they were measured
    /// Axes and plots, in gnuplot's language; neither terminal nor output.
    std::string commands;
};

/// `text` as a string of gnuplot's in which nothing is special; control characters become blanks.
std::string gnuplot_string(std::string_view text);

/// The same of a title, in two lines where it has a colon.
std::string gnuplot_title(std::string_view title);

/// The same for a column of a datablock.
std::string gnuplot_cell(std::string_view text);

/// All that gnuplot needs to write NAME.svg and NAME.png into its working folder.
std::string gnuplot_script(const Figure& figure);

/// What `file` holds; nothing where it is no file or cannot be read.
std::string file_bytes(const std::filesystem::path& file);

/// The program gnuplot, found once.
class Gnuplot {
public:
    /// Throws InputError, naming the package to install, where PATH has none.
    Gnuplot();

    /// Writes NAME.gp, NAME.svg and NAME.png into `folder`. Throws InputError if they do not come
    /// out whole (a full disk).
    void draw(const Figure& figure, const std::filesystem::path& folder) const;

private:
    std::filesystem::path program_;
};

}  // namespace controlspace

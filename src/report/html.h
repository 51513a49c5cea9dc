#pragma once

#include <string>
#include <string_view>

#include "report/figure.h"
#include "study/text_table.h"

namespace controlspace {

/// `text` where markup may stand, in elements and in quoted attributes. Control characters, which a
/// page must not hold, become blanks.
std::string html_text(std::string_view text);

/// A picture that lies in the page itself, with its words: `bytes` are those of its SVG or, where
/// it is a raster, of its PNG.
std::string html_figure(const Figure& figure, std::string_view bytes);

/// A table with its title and note; a click on a column's head sorts by it.
std::string html_table(const TextTable& table);

/// A whole page around `body`, well-formed XML too, that needs no other file and no network.
std::string html_page(std::string_view title, std::string_view body);

}  // namespace controlspace

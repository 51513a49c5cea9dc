// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "controlspace/study/parameter.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace controlspace {

/// The heading of a topic's options in the help.
std::string heading(Topic topic);

/// `text` in lines of at most `width` columns, the first after `label`, whose text begins at
/// `column`; a longer label has a line of its own.
std::string wrapped(std::string_view label, std::string_view text, std::size_t column,
                    std::size_t width);

/// Columns of the terminal that standard output is; 80 where it is none.
std::size_t output_width();

/// Lets `app` and its commands show their options by topics, the user's own first, in lines that
/// fit the terminal. Topics without options are left out.
void set_help(CLI::App& app);

}  // namespace controlspace

#include "cli/info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/filled_space.h"
#include "cli/input_study.h"
#include "cli/space_info.h"
#include "cli/standard_output.h"
#include "io/text/indefinite_tensors.h"

namespace controlspace {
namespace {

std::string sources_info(const SourceSummary& s) {
    std::string text =
        fmt::format("  sources      {}, all of them positive definite\n  extent       {}\n{}",
                    s.count, to_string(s.extent), lengths_text(s));
    text += fmt::format(
        "  gradation    {:.4g} at most, between a source and the six nearest (g_r of the cone "
        "law)\n",
        s.gradation);
    if (s.contradictory > 0) {
        text += fmt::format("  same places  {} sources lie where another asks for something else\n",
                            s.contradictory);
    }
    return text;
}

/// Where some tensors are wrong, others may be read wrongly: their range tells.
std::string indefinite_info(const IndefiniteTensors& tensors) {
    constexpr std::size_t shown = 5;
    const auto& wrong = tensors.indefinite();
    const LengthSummary definite = summarise_lengths(tensors.definite());
    const std::size_t all = definite.count + wrong.size();
    const auto first = wrong.begin() + static_cast<std::ptrdiff_t>(std::min(shown, wrong.size()));
    std::string text = fmt::format(
        "  sources      {}, {} of them ({:.4g} %) positive definite; not so: {}{}\n  refused      "
        "by other commands: {}\n",
        all, definite.count, 100 * static_cast<double>(definite.count) / static_cast<double>(all),
        fmt::join(wrong.begin(), first, ", "), wrong.size() > shown ? ", ..." : "", tensors.what());
    if (definite.count > 0) text += lengths_text(definite);
    return text;
}

std::string info_text(const InfoOptions& options) {
    if (is_control_space(options.input)) {
        require_no_settings(options.input, options.settings);
        return space_info(options.input);
    }
    const std::string name = options.input.string() + "\n";
    try {
        return name + sources_info(summarise(sources_of_input(options.input, options.settings)));
    } catch (const IndefiniteTensors& tensors) {
        return name + indefinite_info(tensors);
    }
}

}  // namespace

std::string lengths_text(const LengthSummary& s) {
    return fmt::format(
        "  isotropic    {} of them\n"
        "  sizes        {:.6g} to {:.6g}, {:.6g} in the mean\n"
        "  anisotropy   {:.4g} at most\n",
        s.isotropic, s.finest, s.coarsest, s.mean, s.anisotropy);
}

void info(const InfoOptions& options) { print(info_text(options)); }

}  // namespace controlspace

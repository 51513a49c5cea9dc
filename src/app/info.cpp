#include "app/info.h"

#include <fmt/format.h>

#include <string>

#include "app/input_study.h"
#include "app/standard_output.h"
#include "measure/source_summary.h"

namespace controlspace {

void info(const InfoOptions& options) {
    const SourceSummary s = summarise(sources_of_input(options.input, options.settings));
    std::string text = fmt::format(
        "{}\n"
        "  sources      {}, all of them positive definite\n"
        "  isotropic    {} of them\n"
        "  extent       {}\n"
        "  sizes        {:.6g} to {:.6g}, {:.6g} in the mean\n"
        "  anisotropy   {:.4g} at most\n"
        "  gradation    {:.4g} at most, between a source and the six nearest (g_r of the cone "
        "law)\n",
        options.input.string(), s.count, s.isotropic, to_string(s.extent), s.finest, s.coarsest,
        s.mean, s.anisotropy, s.gradation);
    if (s.contradictory > 0) {
        text += fmt::format("  same places  {} sources lie where another asks for something else\n",
                            s.contradictory);
    }
    print(text);
}

}  // namespace controlspace

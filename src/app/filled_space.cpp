#include "app/filled_space.h"

#include <fmt/format.h>

#include "app/input_study.h"
#include "app/readers.h"
#include "app/threads.h"
#include "baselines/catalogue.h"
#include "error.h"
#include "spaces/control_space_file.h"
#include "study/run.h"

namespace controlspace {

bool is_control_space(const std::filesystem::path& input) { return input.extension() == ".ctrl"; }

std::unique_ptr<ControlSpace> load_input(const std::filesystem::path& input,
                                         const GivenSettings& given) {
    if (!given.empty()) {
        throw InputError(fmt::format("{}: {} was made with its own: leave it out",
                                     option_name(given.front().first), input.string()));
    }
    return load_control_space(input, structures());
}

std::unique_ptr<ControlSpace> filled_space(const std::filesystem::path& input,
                                           const GivenSettings& given) {
    if (is_control_space(input)) return load_input(input, given);
    const Study study = study_of_input(input, given);
    const auto threads = limit_threads(study.threads);
    const Case c = only_case(study);
    const Workload workload = make_workload(study, c.sources, file_readers());
    Measures unused;
    return make_and_fill(study, c, entry_of(c, structures()), workload, unused, {});
}

}  // namespace controlspace

#include "cli/setting_options.h"

#include "study/settings.h"

namespace controlspace {

GivenSettings given_settings(const WordsByKey& given) {
    GivenSettings settings;
    for (const auto& [key, words] : given) {
        if (!words.empty()) settings.emplace_back(key, words);
    }
    return settings;
}

std::string type_name(ValueType type, std::size_t at_most) {
    const std::string name = type == ValueType::number         ? "NUMBER"
                             : type == ValueType::whole_number ? "COUNT"
                                                               : "TEXT";
    return at_most == 0   ? name + ",..."
           : at_most == 1 ? name
                          : fmt::format("{} x {}", name, at_most);
}

void add_study_input(CLI::App& command, std::filesystem::path& input) {
    command
        .add_option("INPUT", input,
                    "Study file (.toml) or file of sources; left out: the paper's sphere")
        ->option_text("FILE");
}

void add_filled_input(CLI::App& command, std::filesystem::path& input) {
    command
        .add_option("INPUT", input,
                    "Study file (.toml), file of sources, or control space (.ctrl); left out: the "
                    "paper's sphere")
        ->option_text("FILE");
}

void add_making_options(CLI::App& command, WordsByKey& given, std::string_view another) {
    const std::string_view without[] = {
        "name",   "access_points", "access_repeats", "probe_grid", "fine_probe_grid",
        "output", "reference",     another};
    Run defaults;
    defaults.structures = {"K_oL"};
    defaults.splits = {SplitRule::middle};
    add_options(command, run_settings(), defaults, "Settings of the structure (a value each)",
                given, without);
    add_options(command, study_settings(), Study{}, "Settings of the study", given, without);
}

}  // namespace controlspace

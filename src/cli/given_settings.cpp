// SPDX-License-Identifier: Apache-2.0
#include "cli/given_settings.h"

#include <algorithm>
#include <charconv>

#include "cli/paper_reference.h"

namespace controlspace {

Values values_of(ValueType type, const std::vector<std::string>& words) {
    Values values;
    for (const std::string& word : words) {
        double x = 0;
        const char* end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, x);
        if (type != ValueType::text && read.ec == std::errc() && read.ptr == end) {
            values.emplace_back(x);
        } else {
            values.emplace_back(word);
        }
    }
    return values;
}

std::string option_name(std::string_view key) {
    std::string name = "--";
    name += key;
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

void apply(const GivenSettings& given, Study& study) {
    apply(given, study_parameters(), study);
    for (Run& run : study.runs) {
        if_given(given, structures_key, ValueType::text,
                 [&](const Values& values) { run.set_structures(values); });
        for (const CaseParameter& p : program_parameters()) {
            if_given(given, p.key, p.access.type,
                     [&](const Values& values) { run.set(p, values, program_parameters()); });
        }
    }
}

}  // namespace controlspace

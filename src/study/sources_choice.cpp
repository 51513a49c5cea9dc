// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/sources_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "controlspace/fields/ugawg_fields.h"

namespace controlspace {

std::vector<std::string> source_names(const SourcesChoice& s) {
    std::vector<std::string> names;
    const bool is_word = is_sampled(s) || (s.kind == SourcesKind::none && s.primitives.empty());
    if (is_word) names.emplace_back(name_of(s.kind));
    for (const auto& file : s.files) names.push_back(file.string());
    for (const Primitive& primitive : s.primitives) names.push_back(to_string(primitive));
    return names;
}

std::string sources_name(const SourcesChoice& s) {
    return fmt::format("{}", fmt::join(source_names(s), ","));
}

std::vector<std::filesystem::path> input_files_of(const SourcesChoice& s) {
    std::vector<std::filesystem::path> files = s.files;
    for (const Primitive& primitive : s.primitives) {
        if (primitive.shape == Shape::surface) files.push_back(primitive.file);
    }
    if (!s.field.file.empty()) files.push_back(s.field.file);
    return files;
}

AnalyticField make_field(const FieldChoice& choice) {
    switch (choice.kind) {
        case FieldKind::sphere:
            return sphere_field(
                {.centre = choice.centre, .radius = choice.radius, .lengths = choice.lengths});
        case FieldKind::planes:
            return planes_field({.slope = choice.slope, .lengths = choice.lengths});
        case FieldKind::ugawg_linear:
            return ugawg_linear();
        case FieldKind::ugawg_polar_1:
            return ugawg_polar_1();
        case FieldKind::ugawg_polar_2:
            return ugawg_polar_2();
        case FieldKind::none:
        case FieldKind::file:
            break;
    }
    throw std::invalid_argument("make_field: no formula");
}

}  // namespace controlspace

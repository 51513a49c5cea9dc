#include "controlspace/study/sources_choice.h"

#include <stdexcept>

#include "controlspace/fields/ugawg_fields.h"

namespace controlspace {

std::string sources_name(const SourcesChoice& s) {
    switch (s.kind) {
        case SourcesKind::sphere:
            return "sphere";
        case SourcesKind::planes:
            return "planes";
        case SourcesKind::none:
            return "none";
        case SourcesKind::file:
            break;
    }
    std::string names = s.file.string();
    for (const auto& file : s.further_files) names.append(1, ',').append(file.string());
    return names;
}

std::vector<std::filesystem::path> files_of(const SourcesChoice& s) {
    std::vector<std::filesystem::path> files{s.file};
    files.insert(files.end(), s.further_files.begin(), s.further_files.end());
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

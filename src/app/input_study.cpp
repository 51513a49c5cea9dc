#include "app/input_study.h"

#include "error.h"
#include "study/study_file.h"

namespace controlspace {

Study study_of_input(const std::filesystem::path& input, const GivenSettings& given) {
    Study study;
    if (input.extension() == ".toml") {
        study = read_study(input);
    } else {
        study.runs.front().structures = {"K_oL"};
        study.runs.front().splits = {SplitRule::middle};
        if (!input.empty()) {
            study.sources.kind = SourcesKind::file;
            study.sources.file = input;
        }
    }
    apply(given, study);
    return study;
}

void require_set_voxels(const Case& c) {
    if (!c.equal_delta && !c.equal_memory) return;
    throw InputError("equal_delta and equal_memory are for compare: give voxel as it found it");
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
// Uses the installed component core without any other.
#include <controlspace/space/catalogue.h>
#include <controlspace/space/control_space_file.h>
#include <controlspace/space/make_control_space.h>
#include <controlspace/version.h>

#include <vector>

using namespace controlspace;

int main(int argc, char** argv) {
    const std::vector<PointSource> sources{{Point(0.3, 0.2, 0.1), Metric::isotropic(0.05)}};
    const auto space = make_control_space(
        "K_oV", sources, {.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .ratio = 1.25});
    save_control_space("core_alone.ctrl", *space);
    const Point x(-0.9, -0.9, -0.9);
    return argc == 2 && version() == argv[1] && space->length_at(x) > 0.2 &&
                   load_control_space("core_alone.ctrl", tree_catalogue())->length_at(x) ==
                       space->length_at(x)
               ? 0
               : 1;
}

// SPDX-License-Identifier: Apache-2.0
// A control space that was saved and loaded is the same, now and later.
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "sources/files.h"

namespace controlspace::saving_test {
namespace {

std::vector<Metric> answers(const ControlSpace& space) {
    return answers(space, random_points(space.domain(), 2000, 1));
}

// The same parts in the same memory, but for room to grow.
void check_alike(const Footprint& loaded, const Footprint& saved) {
    CHECK(loaded.tree_nodes == saved.tree_nodes);
    CHECK(loaded.cells == saved.cells);
    CHECK(loaded.control_nodes == saved.control_nodes);
    CHECK(loaded.depth == saved.depth);
    CHECK(loaded.bytes_total() <= saved.bytes_total());
}

// Saves, loads, and checks that both are alike, and stay so with another source.
void check_saving(EditableSpace& space, const ScratchDirectory& scratch) {
    save_control_space(scratch / "field.ctrl", space);
    const auto loaded = load_editable(scratch / "field.ctrl", structures());
    CHECK(recipe_of(loaded->built())->structure == recipe_of(space.built())->structure);
    CHECK(answers(*load_control_space(scratch / "field.ctrl", structures())) == answers(space));
    CHECK(checksum(answers(*loaded)) == checksum(answers(space)));
    check_alike(loaded->footprint(), space.footprint());
    save_control_space(scratch / "again.ctrl", *loaded);
    CHECK(file_text(scratch / "again.ctrl") == file_text(scratch / "field.ctrl"));

    const Box domain = space.domain();
    const PointSource later{domain.low + Vector(0.55, 0.4, 0.65).cwiseProduct(domain.edges()),
                            Metric::isotropic(0.06)};
    CHECK(loaded->insert(later) == space.insert(later));
    loaded->grade({});
    space.grade({});
    CHECK(checksum(answers(*loaded)) == checksum(answers(space)));
    CHECK(loaded->control_nodes(Neighbourhood::faces).metrics ==
          space.control_nodes(Neighbourhood::faces).metrics);
}

}  // namespace

STRUCTURE_CASE(does_not_round, "saved between a later source and the gradation that it waits for") {
    const ScratchDirectory scratch("saving");
    const Work work = isotropic_sphere();
    SpaceOptions options = work.options();
    options.takes_later_sources = true;
    const auto space = editable(structure.make(options));
    space->insert(work.sources);
    space->grade({});
    space->insert({Point(-0.3, 0.5, 0.2), Metric::isotropic(0.05)});
    check_saving(*space, scratch);
}

STRUCTURE_CASE(has_compact_form,
               "a frozen control space is frozen again after loading, with the same bits") {
    const ScratchDirectory scratch("saving");
    const Work work = GENERATE(isotropic_sphere(), anisotropic_sphere(), flat_box());
    std::vector<Precision> precisions{Precision::doubles, Precision::floats};
    if (work.isotropic()) {
        precisions.insert(precisions.end(), {Precision::log16, Precision::log8});
    }
    const Precision precision = GENERATE_COPY(from_range(precisions));
    CAPTURE(work.name, static_cast<int>(precision));
    const auto frozen = work.graded(structure)->compact(precision);
    save_control_space(scratch / "frozen.ctrl", *frozen);
    const auto loaded = load_control_space(scratch / "frozen.ctrl", structures());
    CHECK(recipe_of(*loaded)->precision == precision);
    CHECK(answers(*loaded) == answers(*frozen));
    const auto nodes = [](const ControlSpace& space) {
        return control_nodes(space, Neighbourhood::faces).value();
    };
    CHECK(positions(nodes(*loaded).graph) == positions(nodes(*frozen).graph));
    CHECK(nodes(*loaded).metrics == nodes(*frozen).metrics);
    check_alike(loaded->footprint(), frozen->footprint());
    CHECK(loaded->footprint().bytes_total() == frozen->footprint().bytes_total());
    CHECK_THROWS_AS(load_builder(scratch / "frozen.ctrl", structures()), InputError);
    save_control_space(scratch / "again.ctrl", *loaded);
    CHECK(file_text(scratch / "again.ctrl") == file_text(scratch / "frozen.ctrl"));
}

STRUCTURE_CASE(every_structure,
               "a new control space, an adapted and a pruned one can be saved too") {
    const ScratchDirectory scratch("saving");
    const Work work = isotropic_sphere();
    SpaceOptions options = work.options();
    if (structure.has<Pruning>()) options.prune_delta = 0.05;
    const auto space = editable(structure.make(options));
    save_control_space(scratch / "new.ctrl", *space);
    const auto loaded = load_control_space(scratch / "new.ctrl", structures());
    CHECK(answers(*loaded) == answers(*space));
    space->adapt({.sources = work.sources, .continuous = nullptr, .target = 0.2});
    save_control_space(scratch / "adapted.ctrl", *space);
    const auto adapted = load_control_space(scratch / "adapted.ctrl", structures());
    CHECK(checksum(answers(*adapted)) == checksum(answers(*space)));
    check_alike(adapted->footprint(), space->footprint());
    if (!structure.has<Pruning>() || !has_compact_form(structure)) return;
    // What codes stand for depends on the lengths that are left.
    const auto pruned = editable(structure.make(options));
    pruned->insert(work.sources);
    pruned->grade({});
    for (const Precision precision : {Precision::floats, Precision::log16, Precision::log8}) {
        CAPTURE(static_cast<int>(precision));
        const auto compact = pruned->compact(precision);
        save_control_space(scratch / "pruned.ctrl", *compact);
        const auto again = load_control_space(scratch / "pruned.ctrl", structures());
        CHECK(answers(*again) == answers(*compact));
    }
}

}  // namespace controlspace::saving_test

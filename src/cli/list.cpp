// The command `list`: structures, and the other names that options take.
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "study/names.h"

namespace controlspace {
namespace {

using Entry = std::pair<std::string_view, std::string_view>;

std::string section(std::string_view title, std::span<const Entry> entries) {
    std::size_t width = 0;
    for (const auto& [name, description] : entries) width = std::max(width, name.size());
    std::string text = fmt::format("{}\n", title);
    for (const auto& [name, description] : entries) {
        text += fmt::format("  {:{}}  {}\n", name, width, description);
    }
    return text;
}

std::string list_text() {
    std::vector<Entry> entries;
    for (const CatalogueEntry& entry : structures()) {
        entries.emplace_back(entry.id, entry.description);
    }
    const Entry splits[] = {
        {name_of(SplitRule::middle), "middle of the longest axis"},
        {name_of(SplitRule::golden), "golden section of the longest axis, nearer to the source"},
        {name_of(SplitRule::exact_golden), "the same with sections to all digits, not to five"},
        {name_of(SplitRule::metric), "so that the source's part is l_min long in its metric"}};
    const Entry laws[] = {
        {name_of(GradationLaw::cone), "h1 <= h0 + (g_r - 1) |v|, as in the exact reference"},
        {name_of(GradationLaw::mean_length), "the paper's: over the mean of both metric lengths"}};
    const Entry schedules[] = {
        {name_of(GradationSchedule::queue), "until nothing changes"},
        {name_of(GradationSchedule::passes), "at most ten passes, as in the paper's tables"}};
    const Entry neighbourhoods[] = {
        {name_of(Neighbourhood::faces), "nodes across faces, at vertices along edges"},
        {name_of(Neighbourhood::all), "those across edges and corners too"}};
    const Entry node_values[] = {
        {name_of(NodeValues::graded), "as gradation leaves them"},
        {name_of(NodeValues::exact), "the reference there: the error of interpolation alone"}};
    const Entry frozen[] = {{name_of(Frozen::no), "trees stay as they are made"},
                            {name_of(Frozen::doubles), "compact and only read, the same bits"},
                            {name_of(Frozen::floats), "metrics rounded by 6e-8"}};
    const Entry references[] = {
        {name_of(ReferenceKind::exact), "intersection of the cones of all sources"},
        {name_of(ReferenceKind::published_sphere),
         "the analytic field behind the paper's Table 4"}};
    const Entry samplings[] = {
        {name_of(Sampling::regular), "in rows, as in the paper"},
        {name_of(Sampling::random), "each anywhere on the surface"},
        {name_of(Sampling::clustered), "around a few places on the surface, nearly normal"},
        {name_of(Sampling::poisson), "anywhere, but no two nearer than h rho"}};
    const Entry fields[] = {
        {name_of(FieldKind::sphere), "lengths across and along a sphere, growing with distance"},
        {name_of(FieldKind::planes), "the same for two planes that cross"},
        {name_of(FieldKind::ugawg_linear), "UGAWG's benchmark: a layer at z = 0.5, 100:1"},
        {name_of(FieldKind::ugawg_polar_1), "a layer at r = 0.5 around the z axis, 100:1"},
        {name_of(FieldKind::ugawg_polar_2), "the same, shorter along the arc too"}};
    return section("Structures (--structures)", entries) +
           section("\nSplits of kd-trees (--splits)", splits) +
           section("\nLaws of gradation (--law)", laws) +
           section("\nSchedules of gradation (--schedule)", schedules) +
           section("\nNodes that gradation compares (--neighbourhood)", neighbourhoods) +
           section("\nWhat control nodes hold (--node-values)", node_values) +
           section("\nForms of trees (--frozen)", frozen) +
           section("\nReferences (--reference)", references) +
           section("\nSampling of surfaces (--sampling)", samplings) +
           section("\nAnalytic fields (--field)", fields);
}

}  // namespace

Action add_list(Options&) {
    return [](const std::string&) {
        print(list_text());
        return 0;
    };
}

}  // namespace controlspace

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "controlspace/gradation/law.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/parameter.h"
#include "space/depth_limits.h"

namespace controlspace {
namespace {

/// A member of Case::sources.
template <class Member>
auto of_sources(Member SourcesChoice::*member) {
    return [member](auto& c) -> auto& { return c.sources.*member; };
}
auto field_kind = [](auto& c) -> auto& { return c.sources.field.kind; };

template <class Place>
Access<Case> number_of(Place place, const Check& check = positive) {
    return number<Case>(place, check);
}
template <class Place>
Access<Case> number_or_none(Place place) {
    return number<Case>(place, at_least(0), Zero::is_none);
}

bool samples(const Case& c) { return is_sampled(c.sources); }

template <class Capability>
bool has(const CatalogueEntry& entry, const Case&) {
    return entry.has<Capability>();
}
bool is_octree(const CatalogueEntry& entry, const Case&) {
    return entry.has<SourceLeaves>() && !entry.has<SplitRules>();
}
/// Nodes of trees and meshes lie where a field requires them, those of grids on a lattice.
bool chooses_nodes(const CatalogueEntry& entry, const Case&) {
    return entry.has<SourceLeaves>() || (entry.has<MetricNodes>() && !entry.has<VoxelSize>());
}
/// An adapted tree is not graded: it is exact at its nodes.
bool is_graded(const CatalogueEntry& entry, const Case& c) {
    return entry.has<MetricNodes>() && !c.target_delta;
}
bool is_inserted_into(const CatalogueEntry& entry, const Case& c) {
    return entry.has<SourceLeaves>() && !c.target_delta;
}
bool is_sized_by_tau(const CatalogueEntry& entry, const Case& c) {
    return is_inserted_into(entry, c) || (entry.has<VoxelSize>() && !c.voxel);
}
/// Adapted trees are the same with all rules.
bool is_cut_by_rule(const CatalogueEntry& entry, const Case& c) {
    return entry.has<SplitRules>() && !c.target_delta;
}

/// The deepest level of trees of one kind.
Access<Case> depth_if(bool with_split) {
    Access<Case> depth = number_of(
        [](auto& c) -> auto& { return c.max_depth; },
        within(0, with_split ? deepest_kd_level : deepest_octree_level));
    depth.get = [get = depth.get, with_split](const Case& c) {
        return c.split.has_value() == with_split ? get(c) : Values{};
    };
    return depth;
}

/// Adapted trees follow no rule: one of the rules stands for all.
Access<Case> target() {
    Access<Case> access = number_or_none(&Case::target_delta);
    access.set = [set = access.set](Case& c, const Values& values) {
        set(c, values);
        if (c.target_delta && c.split) c.split = SplitRule::middle;
    };
    return access;
}

/// The same by the largest factor between lengths.
Access<Case> target_factor() {
    Access<Case> access = number_or_none(&Case::within);
    access.set = [set_factor = access.set, set_target = target().set](Case& c,
                                                                      const Values& values) {
        set_factor(c, values);
        if (!c.within) return;
        if (!(*c.within >= 1.0001 && *c.within <= 1e6))
            throw InputError("give a factor from 1.0001 to 1e6");
        set_target(c, Values{nonconformity_of_factor(*c.within)});
    };
    return access;
}

/// g_r from another program's number, above 1 as its logarithm is taken.
Access<Case> ratio_from(double (*convert)(double)) {
    Access<Case> access;
    access.set = [convert, check = at_least(1)](Case& c, const Values& values) {
        c.g_r = convert(check(values.front().number()));
    };
    access.get = [](const Case&) { return Values{}; };
    return access;
}

Access<Case> gradation_ratio() {
    Access<Case> access = number_of(&Case::g_r, within(1, 1e6));
    access.set = [set = access.set](Case& c, const Values& values) {
        set(c, values);
        // Others share their sources between ratios.
        if (!c.sources.primitives.empty()) c.sources.primitives_ratio = c.g_r;
    };
    return access;
}

Access<Case> reference_of(std::span<const ReferenceKind* const> kinds) {
    Access<Case> access;
    access.type = ValueType::text;
    for (const ReferenceKind* kind : kinds) access.choices.push_back({kind->name, kind->meaning});
    access.set = [kinds, choices = access.choices](Case& c, const Values& values) {
        require_choice(values.front().text(), choices);
        c.reference = *std::ranges::find(kinds, values.front().text(), &ReferenceKind::name);
    };
    access.get = [](const Case& c) { return Values{c.reference->name}; };
    return access;
}

using Label = std::function<std::string(const Case&)>;

/// FORMAT of the number at `place`, where there is one.
template <class Place>
Label if_given(const char* format, Place place) {
    return [=](const Case& c) -> std::string {
        const std::optional<double> x = std::invoke(place, c);
        return x ? fmt::format(fmt::runtime(format), *x) : "";
    };
}
/// FORMAT of the word at `place`, where it is not that of a new Case.
template <class Place>
Label if_chosen(const char* format, Place place) {
    return [=](const Case& c) -> std::string {
        const auto value = std::invoke(place, c);
        static const Case defaults;
        if (value == std::invoke(place, defaults)) return "";
        return fmt::format(fmt::runtime(format), name_of(value));
    };
}
template <class Place>
Label word_label(const char* format, Place place) {
    return [=](const Case& c) {
        return fmt::format(fmt::runtime(format), name_of(std::invoke(place, c)));
    };
}

/// Rows of each role.
CaseParameter work(const char* key, const char* unit, const char* help, Access<Case> access,
                   Values defaults, Label label) {
    return {
        {key, unit, help, std::move(access)}, Role::work, std::move(defaults), std::move(label)};
}
CaseParameter of_samples(CaseParameter row) {
    row.applies_to = {"sampled surfaces", samples};
    row.label = [label = row.label](const Case& c) { return samples(c) ? label(c) : ""; };
    return row;
}
CaseParameter form_of_g_r(const char* key, const char* help, double (*convert)(double)) {
    return {{key, "", help, ratio_from(convert)}, Role::work, {}, {}, {}, {}, "g_r"};
}
using Fits = std::function<bool(const CatalogueEntry&, const Case&)>;
CaseParameter method(const char* key, const char* unit, const char* help, Access<Case> access,
                     Values defaults, Fits fits, Label label) {
    return {{key, unit, help, std::move(access)},
            Role::method,
            std::move(defaults),
            std::move(label),
            std::move(fits)};
}
CaseParameter structure(const char* key, const char* unit, const char* help, Access<Case> access,
                        Values defaults, Fits fits, Label label, const char* result_key = "") {
    return {{key, unit, help, std::move(access)},
            Role::structure,
            std::move(defaults),
            std::move(label),
            std::move(fits),
            result_key};
}

Topic topic_of(const CaseParameter& row) {
    static const std::map<Topic, std::set<std::string>> others{
        {Topic::accuracy,
         {"within", "target_delta", "equal_delta", "equal_memory", "epsilon", "tau", "reference"}},
        {Topic::fields, {"field"}},
        {Topic::paper, {"law", "schedule", "intersection", "interpolation", "neighbourhood"}}};
    for (const auto& [topic, keys] : others) {
        if (keys.contains(row.key)) return topic;
    }
    if (row.applies_to.is_true_of) return Topic::paper;  // of its samples
    return row.role == Role::structure ? Topic::structures : Topic::sizes;
}

}  // namespace

std::vector<CaseParameter> case_parameters_with(std::span<const ReferenceKind* const> references) {
    using S = SourcesChoice;
    std::vector<CaseParameter> rows{
        work("field", "", "Continuous field that is requested besides the sources",
             word<Case>(field_kind), {"none"}, if_chosen("field {}", field_kind)),
        of_samples(work("sampling", "", "How sampled sources are placed",
                        word<Case>(of_sources(&S::sampling)), {"regular"},
                        if_chosen("{} sources", of_sources(&S::sampling)))),
        of_samples(work("rho", "h", "Spacing of sampled sources", number_of(of_sources(&S::rho)),
                        {1}, if_given("rho {}", of_sources(&S::rho)))),
        of_samples(work("s_a", "h", "Tangential length of sampled sources",
                        number_of(of_sources(&S::s_a)), {2},
                        if_given("s_a {}", of_sources(&S::s_a)))),
        of_samples(work("s_n", "tangential length", "Normal length of sampled sources",
                        number_of(of_sources(&S::s_n)), {1},
                        if_given("s_n {}", of_sources(&S::s_n)))),
        work("g_r", "", "Gradation ratio, 1 or more", gradation_ratio(), {1.25},
             if_given("g_r {:.6g}", &Case::g_r)),
        form_of_g_r("mmg_hgrad", "Gradation ratio as MMG's -hgrad: g_r = 1 + ln(hgrad)",
                    gradation_ratio_from_mmg),
        form_of_g_r("refine_beta", "Gradation ratio as refine's beta: g_r = 1 + ln(beta)",
                    gradation_ratio_from_refine),
        work("reference", "", "Field to compare with", reference_of(references),
             {references.front()->name},
             [](const Case& c) { return c.reference->name + " reference"; }),
        work(
            "intersection", "",
            "Intersection of the cones of anisotropic sources, in the exact reference, adaptation, "
            "and structures that keep sources",
            word<Case>(&Case::intersection), {"order-free"},
            if_chosen("{} intersection", &Case::intersection)),
        work("law", "", "Law of gradation", word<Case>(&Case::law), {"cone"},
             word_label("{} law", &Case::law)),
        method("schedule", "", "Gradation of control nodes: by the sources, or from node to node",
               word<Case>(&Case::schedule), {"sources"}, is_graded,
               word_label("{}", &Case::schedule)),
        method("epsilon", "",
               "Insertion tolerance: non-conformity below which a source is satisfied",
               number_of(&Case::epsilon), {0.2}, is_inserted_into,
               if_given("epsilon {}", &Case::epsilon)),
        method("tau", "metric length at the source", "l_min: longest edge of the leaf of a source",
               number_of(&Case::tau), {1}, is_sized_by_tau, if_given("tau {}", &Case::tau)),
        structure("splits", "", "Where kd-trees cut", word<Case>(&Case::split),
                  {"s_L", "s_G", "s_M"}, is_cut_by_rule, {}, "split"),
        structure("kd_depth", "", "Deepest level of kd-trees, the root being 0", depth_if(true),
                  {42}, has<SplitRules>, {}, "max_depth"),
        structure("octree_depth", "", "Deepest level of octrees, the root being 0", depth_if(false),
                  {14}, is_octree, {}, "max_depth"),
        structure("interpolation", "", "Interpolation in quadratic leaves (K_Li, K_oLi)",
                  word<Case>(&Case::interpolation), {"corrected"}, has<QuadraticLeaves>,
                  [](const Case& c) {
                      const bool published = c.interpolation == QuadraticForm::published;
                      return published ? "published interpolation" : "";
                  }),
        structure(
            "target_delta", "",
            "Non-conformity to the exact field that trees and meshes are adapted to, in place of "
            "insertion and gradation; 0: not adapted",
            target(), {0}, chooses_nodes,
            [](const Case& c) -> std::string {
                if (c.within) return fmt::format("within {:.4g}x", *c.within);
                return c.target_delta ? fmt::format("δ <= {:.4g}", *c.target_delta) : "";
            }),
        {{"within", "",
          "The same as the largest factor by which a length may differ from the exact field in any "
          "direction: 1.1 is target_delta = 0.01575, with tensors 0.00909; 0: not given",
          target_factor()},
         Role::structure,
         {0},
         {},
         chooses_nodes,
         {},
         "target_delta"},
        structure("equal_delta", "",
                  "Largest delta_R, at all probes, for which voxels are chosen (and prune_delta, "
                  "where that saves memory); 0: not chosen. For trees see target_delta",
                  number_or_none(&Case::equal_delta), {0}, has<VoxelSize>,
                  if_given("for delta {:.4g}", &Case::equal_delta)),
        structure("equal_memory", "MB",
                  "Memory of the finished grid for which its voxels are chosen; 0: not chosen",
                  number_or_none(&Case::equal_memory), {0}, has<VoxelSize>,
                  if_given("for {:.4g} MB", &Case::equal_memory)),
        structure("voxel", "length",
                  "Longest edge of a grid's voxels; 0: tau times the smallest requested "
                  "length",
                  number_or_none(&Case::voxel), {0}, has<VoxelSize>,
                  if_given("voxel {:.4g}", &Case::voxel)),
        structure("neighbourhood", "",
                  "Neighbours in gradation from node to node: faces, nodes across faces (at "
                  "vertices: along edges) as in the paper; all, those across edges and corners "
                  "too (at vertices: of the same leaf or voxel). None in structures that keep "
                  "sources and in adapted trees",
                  word<Case>(&Case::neighbourhood), {"faces"}, is_graded,
                  if_chosen("{} neighbours", &Case::neighbourhood)),
        structure(
            "frozen", "",
            "Conversion of trees to their compact, read-only form, not timed: no; doubles, the "
            "same bits; floats, metrics rounded by 6e-8",
            word<Case>(&Case::frozen), {"no"}, has<CompactForm>,
            if_chosen("frozen with {}", &Case::frozen)),
        structure("prune_delta", "",
                  "Non-conformity up to which graded OpenVDB grids merge voxels; 0: not merged",
                  number_or_none(&Case::prune_delta), {0}, has<Pruning>,
                  if_given("pruned at {:.4g}", &Case::prune_delta)),
    };
    std::ranges::find(rows, "reference", &CaseParameter::key)->use = Use::accuracy;
    std::ranges::find(rows, "law", &CaseParameter::key)->fits = is_graded;
    for (CaseParameter& row : rows) row.topic = topic_of(row);
    return rows;
}

namespace {

/// The non-empty labels of parameters of a role, joined by commas.
template <class Wanted>
std::string joined(const Case& c, std::span<const CaseParameter> parameters, const Wanted& wanted) {
    std::string text;
    for (const CaseParameter& parameter : parameters) {
        if (!parameter.label || !wanted(parameter)) continue;
        const std::string label = parameter.label(c);
        if (!label.empty()) text += (text.empty() ? "" : ", ") + label;
    }
    return text;
}

}  // namespace

std::span<const CaseParameter> case_parameters() {
    static const ReferenceKind* const exact[] = {&exact_reference_kind()};
    static const std::vector<CaseParameter> all = case_parameters_with(exact);
    return all;
}

Access<Case> other_number(const std::string& key, Check check) {
    Access<Case> access;
    access.set = [key, check = std::move(check)](Case& c, const Values& values) {
        c.other[key] = check(values.front().number());
    };
    access.get = [key](const Case& c) {
        const auto found = c.other.find(key);
        return found == c.other.end() ? Values{} : Values{found->second};
    };
    return access;
}

Values values_of(const CaseParameter& parameter, const Case& c) {
    return parameter.applies(c) ? parameter.access.get(c) : Values{};
}

std::string structure_label(const Case& c, std::span<const CaseParameter> parameters) {
    std::string label = c.structure;
    if (c.split && !c.target_delta) label += fmt::format(" {}", name_of(*c.split));
    const std::string own =
        joined(c, parameters, [](const CaseParameter& p) { return p.role == Role::structure; });
    return own.empty() ? label : label + ", " + own;
}

std::string setting_label(const Case& c, std::span<const CaseParameter> parameters) {
    return joined(c, parameters, [](const CaseParameter& p) { return p.role != Role::structure; });
}

std::string work_label(const Case& c, std::span<const CaseParameter> parameters) {
    return joined(c, parameters, [](const CaseParameter& p) { return p.role == Role::work; });
}

std::string method_label(const Case& c, std::span<const CaseParameter> parameters) {
    const std::string method = joined(c, parameters, [&](const CaseParameter& p) {
        if (p.role != Role::method) return false;
        const Values values = values_of(p, c);
        return !values.empty() && values.front() != p.defaults.front();
    });
    return structure_label(c, parameters) + (method.empty() ? "" : ", " + method);
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "controlspace/gradation/law.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/parameter.h"
#include "refuse.h"
#include "study/member_of.h"

namespace controlspace {
namespace {

Access<Case> number_or_none(std::optional<double> Case::*place) {
    return number<Case>(place, at_least(0), Zero::is_none);
}

template <class Capability>
bool has(const CatalogueEntry& entry, const Case&) {
    return entry.has<Capability>();
}
bool is_octree(const CatalogueEntry& entry, const Case&) {
    return entry.has<SourceLeaves>() && !entry.has<SplitRules>();
}
/// Trees and meshes choose where nodes lie, grids their voxels.
bool is_adapted_to(const CatalogueEntry& entry, const Case&) {
    return entry.has<SourceLeaves>() || entry.has<MetricNodes>();
}
/// An adapted tree is not graded: it is exact at its nodes.
bool is_graded(const CatalogueEntry& entry, const Case& c) {
    return entry.has<MetricNodes>() && !c.target_delta;
}
bool is_inserted_into(const CatalogueEntry& entry, const Case& c) {
    return entry.has<SourceLeaves>() && !c.target_delta;
}
bool is_sized_by_tau(const CatalogueEntry& entry, const Case& c) {
    return is_inserted_into(entry, c) || (entry.has<VoxelSize>() && !c.voxel && !c.target_delta);
}
bool is_adapted_tree(const CatalogueEntry& entry, const Case& c) {
    return entry.has<SourceLeaves>() && (c.target_delta || has_field(c.sources));
}
bool is_fitted(const CatalogueEntry& entry, const Case& c) {
    return entry.has<FittedValues>() && c.target_delta;
}
/// Adapted trees are the same with all rules.
bool is_cut_by_rule(const CatalogueEntry& entry, const Case& c) {
    return entry.has<SplitRules>() && !c.target_delta;
}

/// The deepest level of trees of one kind.
Access<Case> depth_if(bool with_split) {
    Access<Case> depth = number<Case>(
        &Case::max_depth, within(0, with_split ? deepest_kd_level : deepest_octree_level),
        Zero::is_none);
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
        if (!(*c.within >= 1.0001 && *c.within <= 1e6)) refuse("give a factor from 1.0001 to 1e6");
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
    Access<Case> access = number<Case>(&Case::g_r, within(1, 1e6));
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

/// Part of a label: the value in a format; that of the default where it tells something.
struct Shown {
    const char* format = nullptr;
    bool is_default_shown = true;
};
Shown unless_default(const char* format) { return {format, false}; }

using Fits = std::function<bool(const CatalogueEntry&, const Case&)>;
CaseParameter row(Role role, const char* key, const char* unit, const char* help,
                  Access<Case> access, Values defaults, Shown shown, Fits fits = {},
                  const char* result_key = "") {
    CaseParameter p{{key, unit, help, std::move(access)}, role, std::move(defaults)};
    p.fits = std::move(fits);
    p.result_key = result_key;
    if (shown.format == nullptr) return p;
    p.label = [shown, get = p.access.get, usual = p.defaults.front()](const Case& c) {
        const Values values = get(c);
        if (values.empty() || (!shown.is_default_shown && values.front() == usual)) {
            return std::string();
        }
        const auto text = [&](const auto& x) { return fmt::format(fmt::runtime(shown.format), x); };
        return std::visit(text, values.front());
    };
    return p;
}
CaseParameter of_samples(CaseParameter row) {
    row.applies_to = {"sampled surfaces", [](const Case& c) { return is_sampled(c.sources); }};
    return row;
}
CaseParameter form_of_g_r(const char* key, const char* help, double (*convert)(double)) {
    return {{key, "", help, ratio_from(convert)}, Role::work, {}, {}, {}, {}, "g_r"};
}

Topic topic_of(const CaseParameter& row) {
    static const std::map<Topic, std::set<std::string>> others{
        {Topic::accuracy,
         {"within", "target_delta", "values", "max_leaves", "equal_delta", "equal_memory",
          "epsilon", "tau", "reference"}},
        {Topic::fields, {"field"}},
        {Topic::paper, {"law", "schedule", "intersection", "interpolation", "neighbourhood"}}};
    for (const auto& [topic, keys] : others) {
        if (keys.contains(row.key)) return topic;
    }
    if (row.applies_to.is_true_of) return Topic::paper;  // of its samples
    return row.role == Role::structure ? Topic::structures : Topic::sizes;
}

}  // namespace

// All forms but as-made.
static constexpr std::pair<StoredIn, Precision> precisions[] = {
    {StoredIn::doubles, Precision::doubles},
    {StoredIn::floats, Precision::floats},
    {StoredIn::log16, Precision::log16},
    {StoredIn::log8, Precision::log8}};

StoredIn stored_in(Precision precision) {
    return std::ranges::find(precisions, precision, [](const auto& p) { return p.second; })->first;
}

std::optional<Precision> precision_of(std::optional<StoredIn> form) {
    for (const auto& [stored, precision] : precisions) {
        if (form == stored) return precision;
    }
    return std::nullopt;
}

std::vector<CaseParameter> case_parameters_with(std::span<const ReferenceKind* const> references) {
    using S = SourcesChoice;
    using enum Role;
    constexpr auto sources = &Case::sources;
    std::vector<CaseParameter> rows{
        row(work, "field", "", "Continuous field that is requested besides the sources",
            word<Case>(of(sources, &S::field, &FieldChoice::kind)), {"none"},
            unless_default("field {}")),
        of_samples(row(work, "sampling", "", "How sampled sources are placed",
                       word<Case>(of(sources, &S::sampling)), {"regular"},
                       unless_default("{} sources"))),
        of_samples(row(work, "rho", "h", "Spacing of sampled sources",
                       number<Case>(of(sources, &S::rho), positive), {1}, {"rho {}"})),
        of_samples(row(work, "s_a", "h", "Tangential length of sampled sources",
                       number<Case>(of(sources, &S::s_a), positive), {2}, {"s_a {}"})),
        of_samples(row(work, "s_n", "tangential length", "Normal length of sampled sources",
                       number<Case>(of(sources, &S::s_n), positive), {1}, {"s_n {}"})),
        row(work, "g_r", "", "Gradation ratio, 1 or more", gradation_ratio(), {1.25},
            {"g_r {:.6g}"}),
        form_of_g_r("mmg_hgrad", "Gradation ratio as MMG's -hgrad: g_r = 1 + ln(hgrad)",
                    gradation_ratio_from_mmg),
        form_of_g_r("refine_beta", "Gradation ratio as refine's beta: g_r = 1 + ln(beta)",
                    gradation_ratio_from_refine),
        row(work, "reference", "", "Field to compare with", reference_of(references),
            {references.front()->name}, {"{} reference"}),
        row(work, "intersection", "",
            "Intersection of the cones of anisotropic sources, in the exact reference, adaptation, "
            "and structures that keep sources",
            word<Case>(&Case::intersection), {"order-free"}, unless_default("{} intersection")),
        row(work, "law", "", "Law of gradation", word<Case>(&Case::law), {"cone"}, {"{} law"},
            is_graded),
        row(method, "schedule", "",
            "Gradation of control nodes: by the sources, or from node to node",
            word<Case>(&Case::schedule), {"sources"}, {"{}"}, is_graded),
        row(method, "epsilon", "",
            "Insertion tolerance: non-conformity below which a source is satisfied",
            number<Case>(&Case::epsilon, positive), {0.2}, {"epsilon {}"}, is_inserted_into),
        row(method, "tau", "metric length at the source",
            "l_min: longest edge of the leaf of a source", number<Case>(&Case::tau, positive), {1},
            {"tau {}"}, is_sized_by_tau),
        row(structure, "splits", "", "Where kd-trees cut", word<Case>(&Case::split),
            {"s_L", "s_G", "s_M"}, {}, is_cut_by_rule, "split"),
        row(structure, "kd_depth", "",
            "Deepest level of kd-trees, the root being level 0; 0: 42 as in the paper, or what "
            "doubles "
            "allow where they are adapted",
            depth_if(true), {0}, {}, has<SplitRules>, "max_depth"),
        row(structure, "octree_depth", "",
            "Deepest level of octrees, the root being level 0; 0: 14 as in the paper, or what "
            "doubles "
            "allow where they are adapted",
            depth_if(false), {0}, {}, is_octree, "max_depth"),
        row(structure, "interpolation", "", "Interpolation in quadratic leaves (K_Li, K_oLi)",
            word<Case>(&Case::interpolation), {"corrected"}, unless_default("{} interpolation"),
            has<QuadraticLeaves>),
        row(structure, "target_delta", "",
            "Non-conformity to the exact field that structures are adapted to, trees by their "
            "leaves, "
            "grids by their voxels, in place of insertion and gradation; 0: not adapted",
            target(), {0}, {"δ <= {:.4g}"}, is_adapted_to),
        row(structure, "within", "",
            "The same as the largest factor by which a length may differ from the exact field in "
            "any direction: 1.1 is target_delta = 0.01575, with tensors 0.00909; 0: not given",
            target_factor(), {0}, {"within {:.4g}x"}, is_adapted_to),
        row(structure, "values", "",
            "What adapted structures that can do so hold at their nodes: the field's own lengths, "
            "or fitted ones, with which fewer nodes keep the same target",
            word<Case>(&Case::values), {"field"}, unless_default("{} values"), is_fitted),
        row(structure, "max_leaves", "",
            "Leaves at which the adaptation of trees stops, though it misses its target; 0: no "
            "limit",
            number<Case>(&Case::max_leaves, at_least(1), Zero::is_none), {default_max_leaves},
            unless_default("to {} leaves"), is_adapted_tree),
        row(structure, "equal_delta", "",
            "Largest delta_R, at all probes, for which voxels are chosen (and prune_delta, where "
            "that saves memory); 0: not chosen. For trees see target_delta",
            number_or_none(&Case::equal_delta), {0}, {"for delta {:.4g}"}, has<VoxelSize>),
        row(structure, "equal_memory", "MB",
            "Memory of the finished grid for which its voxels are chosen; 0: not chosen",
            number_or_none(&Case::equal_memory), {0}, {"for {:.4g} MB"}, has<VoxelSize>),
        row(structure, "voxel", "length",
            "Longest edge of a grid's voxels; 0: tau times the smallest requested length",
            number_or_none(&Case::voxel), {0}, {"voxel {:.4g}"}, has<VoxelSize>),
        row(structure, "neighbourhood", "",
            "Neighbours in gradation from node to node: faces, nodes across faces (at vertices: "
            "along edges) as in the paper; all, those across edges and corners too (at vertices: "
            "of the same leaf or voxel). None in structures that keep sources and in adapted trees",
            word<Case>(&Case::neighbourhood), {"faces"}, unless_default("{} neighbours"),
            is_graded),
        row(structure, "precision", "",
            "Numbers that the finished structure stores its values in, lengths where all is "
            "isotropic: double, float, log16 or log8 (codes of lengths), which are only read; "
            "as-made, metrics in doubles, which takes later sources. A target is kept by what is "
            "read back. Foreign systems have a precision of their own",
            word<Case>(&Case::precision), {"double"}, unless_default("{}"), has<CompactForm>),
        row(structure, "prune_delta", "",
            "Non-conformity up to which graded OpenVDB grids merge voxels; 0: not merged",
            number_or_none(&Case::prune_delta), {0}, {"pruned at {:.4g}"}, has<Pruning>),
    };
    const auto named = [&](const char* key) -> CaseParameter& {
        return *std::ranges::find(rows, key, &CaseParameter::key);
    };
    named("reference").use = Use::accuracy;
    named("within").same_as = "target_delta";
    CaseParameter& target_delta = named("target_delta");
    target_delta.label = [label = target_delta.label](const Case& c) {
        return c.within ? std::string() : label(c);  // the target has the label of its other form
    };
    for (CaseParameter& p : rows) p.topic = topic_of(p);
    return rows;
}

namespace {

/// The non-empty labels of parameters of a role, joined by commas.
template <class Wanted>
std::string joined(const Case& c, std::span<const CaseParameter> parameters, const Wanted& wanted) {
    std::string text;
    for (const CaseParameter& parameter : parameters) {
        if (!parameter.label || !wanted(parameter) || !parameter.applies(c)) continue;
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

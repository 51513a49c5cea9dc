// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/study.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::vector<const CatalogueEntry*> chosen(const Values& names,
                                          std::span<const CatalogueEntry> catalogue) {
    std::vector<const CatalogueEntry*> entries;
    for (const Value& value : names) {
        const std::string& name = value.text();
        bool known = name == "all";
        std::string all = "all";
        std::vector<std::string> families;
        for (const CatalogueEntry& entry : catalogue) {
            all += ", " + entry.id;
            if (std::ranges::count(families, entry.family) == 0) families.push_back(entry.family);
            const bool former = !name.empty() && entry.former_id == name;
            if (name != "all" && entry.id != name && entry.family != name && !former) continue;
            known = true;
            if (std::ranges::count(entries, &entry) == 0) entries.push_back(&entry);
        }
        if (!known) {
            refuse("unknown structure '{}': give a family ({}) or some of {}", name,
                   fmt::join(families, ", "), all);
        }
    }
    return entries;
}

/// Lists multiply: an error in a study file should not request a year of work, or all memory.
void require_few(std::size_t cases) {
    constexpr std::size_t most = 5000;
    if (cases > most) refuse("the study has more than {} cases: shorten its lists", most);
}

/// Replaces each case by one for each value; the first list multiplied varies slowest.
void multiply(std::vector<Case>& cases, const CaseParameter& parameter, const Values& values) {
    std::vector<Case> product;
    require_few(cases.size() * values.size());
    for (const Case& c : cases) {
        for (const Value& value : values) {
            set_checked(parameter.access, product.emplace_back(c), {value});
        }
    }
    cases = std::move(product);
}

/// A value other than the default where it does not apply is an error: it was meant for other
/// sources.
bool is_needed(const CaseParameter& parameter, const Run& run, const Case& c) {
    if (parameter.applies(c)) return true;
    if (run.values(parameter) == parameter.defaults) return false;
    refuse("{} is for {}: leave it out", parameter.key, parameter.applies_to.what);
}

std::vector<Case> settings_of(const Study& study, const Run& run,
                              std::span<const CaseParameter> parameters) {
    std::vector<Case> cases(1);
    cases.front().sources = study.sources;
    for (const CaseParameter& p : parameters) {
        if (p.role == Role::structure || p.is_form()) continue;
        if (is_needed(p, run, cases.front())) multiply(cases, p, run.values(p));
    }
    return cases;
}

/// One structure under one setting: what it does not have does not multiply it.
std::vector<Case> variants_of(const CatalogueEntry& entry, const Run& run, const Case& setting,
                              std::span<const CaseParameter> parameters) {
    std::vector<Case> cases{setting};
    cases.front().structure = entry.id;
    for (const CaseParameter& p : parameters) {
        if (p.role != Role::structure || p.is_form()) continue;
        // Without adaptation trees do not follow a field; grids do with the voxels that are given.
        const bool has_voxels = entry.has<VoxelSize>() && run.find("voxel") != nullptr;
        const bool is_default_target = p.key == "within" && has_field(setting.sources) &&
                                       run.find("target_delta") == nullptr &&
                                       run.find("within") == nullptr && !has_voxels;
        const Values values = is_default_target ? Values{default_within} : run.values(p);
        std::vector<Case> product;
        for (const Case& c : cases) {
            std::vector<Case> made{c};
            if (!p.fits || p.fits(entry, c)) multiply(made, p, values);
            product.insert(product.end(), made.begin(), made.end());
        }
        cases = std::move(product);
    }
    return cases;
}

void require_sensible(const Case& c) {
    if (c.sources.kind == SourcesKind::none && !has_field(c.sources)) {
        refuse("neither sources nor a field: give one of them");
    }
    if (c.sources.field.kind == FieldKind::file && c.sources.field.file.empty()) {
        refuse("field = \"file\" needs field_file: name a .vdb, .vtu or .vti");
    }
    if (!(c.sources.h_min <= c.sources.h_max)) {
        refuse("h_min is {} and h_max {}: give h_min <= h_max", c.sources.h_min, c.sources.h_max);
    }
    c.reference->require_fit(c.sources);
    if (c.equal_delta && c.equal_memory) {
        refuse("equal_delta and equal_memory choose the same voxels: give one of them");
    }
    if ((c.equal_delta || c.equal_memory) && c.voxel) {
        refuse("equal_delta and equal_memory choose voxel: leave it out");
    }
}

/// Fewer of the defaults too: who wants one split needs no remark on octrees.
bool is_default(const Values& values, const Values& defaults) {
    return std::ranges::all_of(
        values, [&](const Value& value) { return std::ranges::count(defaults, value) > 0; });
}

}  // namespace

const Values* Run::find(const std::string& key) const {
    const auto found = lists_.find(key);
    return found == lists_.end() ? nullptr : &found->second;
}

const Values& Run::values(const CaseParameter& parameter) const {
    const Values* list = find(parameter.key);
    return list != nullptr ? *list : parameter.defaults;
}

Values Run::structures() const {
    const Values* list = find(structures_key);
    return list != nullptr ? *list : Values{"all"};
}

void Run::set_structures(const Values& names) {
    require_fit(ValueType::text, 0, names);
    lists_[structures_key] = names;
}

void Run::set(const CaseParameter& parameter, const Values& values,
              std::span<const CaseParameter> all) {
    require_fit(parameter.access.type, 0, values);
    const bool is_second = !parameter.same_as.empty() && !parameter.is_form();
    if (is_second && values == parameter.defaults) {  // not given
        lists_.erase(parameter.key);
        return;
    }
    const auto target = parameter.is_form()
                            ? &*std::ranges::find(all, parameter.same_as, &CaseParameter::key)
                            : &parameter;
    Values list;
    for (const Value& value : values) {
        Case c;
        set_checked(parameter.access, c, {value});
        list.push_back(target == &parameter ? value : target->access.get(c).front());
    }
    // What is given last holds, of those that set the same.
    for (const CaseParameter& other : all) {
        if (other.same_as == target->key || other.key == target->same_as) lists_.erase(other.key);
    }
    lists_[target->key] = std::move(list);
}

std::vector<std::string> settings_without_effect(const Study& study, const Case& c,
                                                 const StudyRows& rows) {
    const CatalogueEntry& entry = *find_entry(rows.structures, c.structure);
    std::vector<std::string> names;
    for (const CaseParameter& p : rows.parameters) {
        if (!p.fits || p.fits(entry, c)) continue;
        const bool is_given = std::ranges::any_of(study.runs, [&](const Run& run) {
            return !is_default(run.values(p), p.defaults) &&
                   std::ranges::count(chosen(run.structures(), rows.structures), &entry) > 0;
        });
        if (!is_given) continue;
        std::string& name = names.emplace_back(p.key);
        for (const CaseParameter& form : rows.parameters) {
            if (form.same_as == p.key) name.append(" (").append(form.key).append(")");
        }
    }
    return names;
}

std::vector<Case> expand(const Study& study, const StudyRows& rows) {
    require_applicable(study);
    std::vector<Case> cases;
    for (const Run& run : study.runs) {
        const auto entries = chosen(run.structures(), rows.structures);
        for (const Case& setting : settings_of(study, run, rows.parameters)) {
            for (const CatalogueEntry* entry : entries) {
                for (const Case& c : variants_of(*entry, run, setting, rows.parameters)) {
                    require_sensible(c);
                    if (std::ranges::count(cases, c) == 0) cases.push_back(c);
                }
                require_few(cases.size());
            }
        }
    }
    if (cases.empty()) refuse("the study has no cases: give at least one structure");
    return cases;
}

}  // namespace controlspace

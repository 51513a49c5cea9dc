#include "study/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controlspace/error.h"
#include "controlspace/gradation/law.h"
#include "study/field_settings.h"
#include "study/file_settings.h"
#include "study/names.h"
#include "study/setting_values.h"
#include "study/vdb_settings.h"

namespace controlspace {
namespace {

template <class Integer>
Integer integer_within(const SettingValue& value, double least, double most) {
    return static_cast<Integer>(within(number(value), least, most));
}

template <class Enum>
Enum named(const SettingValue& value) {
    if (const auto e = from_name<Enum>(text(value))) return *e;
    std::vector<std::string_view> known;
    for (const auto& entry : Names<Enum>::table) known.push_back(entry.second);
    throw InputError(
        fmt::format("unknown value '{}': give {}", text(value), fmt::join(known, ", ")));
}

/// Fills a list of a run from values, each through `convert`.
template <class T, class Convert>
void fill(std::vector<T>& list, const SettingValues& values, Convert&& convert) {
    list.clear();
    for (const SettingValue& value : values) list.push_back(convert(value));
}

template <class Number>
SettingValues numbers(const std::vector<Number>& list) {
    SettingValues values;
    for (const Number x : list) values.emplace_back(static_cast<double>(x));
    return values;
}
template <class Enum>
SettingValues names(const std::vector<Enum>& list) {
    SettingValues values;
    for (const Enum e : list) values.emplace_back(std::string(name_of(e)));
    return values;
}
SettingValues none(const Run&) { return {}; }

template <std::vector<double> Run::*list>
SettingValues get_numbers(const Run& run) {
    return numbers(run.*list);
}
template <std::vector<double> Run::*list>
void set_positive(Run& run, const SettingValues& values) {
    fill(run.*list, values, [](const SettingValue& v) { return positive(number(v)); });
}
template <std::vector<double> Run::*list>
void set_not_negative(Run& run, const SettingValues& values) {
    fill(run.*list, values, [](const SettingValue& v) {
        return within(number(v), 0, std::numeric_limits<double>::max());
    });
}
template <auto list>
SettingValues get_names(const Run& run) {
    return names(run.*list);
}
template <auto list>
void set_names(Run& run, const SettingValues& values) {
    fill(run.*list, values, [](const SettingValue& v) {
        return named<typename std::decay_t<decltype(std::declval<Run>().*list)>::value_type>(v);
    });
}
template <std::vector<int> Run::*list>
SettingValues get_depths(const Run& run) {
    return numbers(run.*list);
}
template <std::vector<int> Run::*list>
void set_depths(Run& run, const SettingValues& values) {
    fill(run.*list, values, [](const SettingValue& v) { return integer_within<int>(v, 0, 1000); });
}
/// g_r from another program's number, which must be above 1 as its logarithm is taken.
template <double (*convert)(double)>
void set_ratio_from(Run& run, const SettingValues& values) {
    fill(run.g_r, values, [](const SettingValue& v) {
        return convert(within(number(v), 1, std::numeric_limits<double>::max()));
    });
}

void set_sources(Study& study, const SettingValues& values) {
    const std::string& what = text(values.front());
    if (what.empty()) throw InputError("no name: give sphere, planes, none or the name of a file");
    study.sources.kind = what == "sphere"   ? SourcesKind::sphere
                         : what == "planes" ? SourcesKind::planes
                         : what == "none"   ? SourcesKind::none
                                            : SourcesKind::file;
    study.sources.file = study.sources.kind == SourcesKind::file ? what : "";
}

SettingValues get_domain(const Study& study) {
    if (!study.domain) return {};
    const Point& a = study.domain->low;
    const Point& b = study.domain->high;
    return {a.x(), b.x(), a.y(), b.y(), a.z(), b.z()};
}

void set_domain(Study& study, const SettingValues& values) {
    if (values.size() != 6) throw InputError("give six numbers: x0 x1 y0 y1 z0 z1");
    const auto x = [&](std::size_t i) { return number(values[i]); };
    study.domain = require_volume({{x(0), x(2), x(4)}, {x(1), x(3), x(5)}});
}

constexpr auto number_type = ValueType::number;
constexpr auto whole = ValueType::whole_number;
constexpr auto text_type = ValueType::text;
constexpr double exact_integers = 9007199254740992.0;  // 2^53: whole numbers pass through doubles

const Setting<Study> general_table[] = {
    {"name", text_type, 1, "", "Name of the study, and of its folder of results",
     [](Study& s, const SettingValues& v) {
         s.name = text(v.front());
         const auto unfit = [](char c) { return c == '/' || (c >= 0 && c < ' ') || c == 127; };
         if (s.name.empty() || std::any_of(s.name.begin(), s.name.end(), unfit)) {
             throw InputError(fmt::format(
                 "'{}' cannot name a folder: leave out '/' and control characters", s.name));
         }
     },
     [](const Study& s) { return SettingValues{s.name}; }},
    {"sources", text_type, 1, "",
     "sphere, planes, or none, for a field alone; or a file of sources: .csv, a pipe of such, "
     ".mesh or .meshb beside .sol or .solb, .pos, .msh, .vtu or .vtp; or a surface: .stl, .obj, "
     ".ply, .off or in a .vdb",
     set_sources, [](const Study& s) { return SettingValues{sources_name(s.sources)}; }},
    {"centre", number_type, 3, "", "x y z: centre of the sphere [length]",
     [](Study& s, const SettingValues& v) { s.sources.centre = point(v); },
     [](const Study& s) { return coordinates(s.sources.centre); }},
    {"radius", number_type, 1, "", "Radius of the sphere [length]",
     [](Study& s, const SettingValues& v) { s.sources.radius = positive(number(v.front())); },
     [](const Study& s) { return one(s.sources.radius); }},
    {"slope", number_type, 1, "", "Slope a of the second plane (u, -0.2 + a u, v)",
     [](Study& s, const SettingValues& v) { s.sources.slope = number(v.front()); },
     [](const Study& s) { return one(s.sources.slope); }},
    {"h", number_type, 1, "", "Length that the sampling of a surface starts from [length]",
     [](Study& s, const SettingValues& v) { s.sources.h = positive(number(v.front())); },
     [](const Study& s) { return one(s.sources.h); }},
    {"domain", number_type, 6, "",
     "x0 x1 y0 y1 z0 z1 [length]; left out: where the field is defined; -1 1 along each axis for "
     "other fields and sampled surfaces; otherwise the box of the sources and a margin",
     set_domain, get_domain},
    {"margin", number_type, 1, "",
     "Margin around sources from a file [longest extent of the sources]",
     [](Study& s, const SettingValues& v) { s.margin = within(number(v.front()), 0, 1000); },
     [](const Study& s) { return one(s.margin); }},
    {"max_memory", number_type, 1, "",
     "Most memory that a structure may take, gradation included [GiB]; a grid is made coarser, a "
     "tree that outgrows it fails",
     [](Study& s, const SettingValues& v) {
         s.max_memory_gib = within(positive(number(v.front())), 0, 1 << 20);
     },
     [](const Study& s) { return one(s.max_memory_gib); }},
    {"seed", whole, 1, "", "Seed of the random places, and of sources that are not regular",
     [](Study& s, const SettingValues& v) {
         s.seed = integer_within<std::uint64_t>(v.front(), 0, exact_integers);
     },
     [](const Study& s) { return one(static_cast<double>(s.seed)); }},
    {"threads", whole, 1, "",
     "Threads for creation, probes and accuracy; access is timed on one; 0: all processors",
     [](Study& s, const SettingValues& v) { s.threads = integer_within<int>(v.front(), 0, 4096); },
     [](const Study& s) { return one(s.threads); }},
    {"access_points", whole, 1, "", "Number of random places that access is timed at",
     [](Study& s, const SettingValues& v) {
         s.access_points = integer_within<std::size_t>(v.front(), 1, 1e8);
     },
     [](const Study& s) { return one(static_cast<double>(s.access_points)); }},
    {"access_repeats", whole, 1, "", "How often access is timed; the median counts",
     [](Study& s, const SettingValues& v) {
         s.access_repeats = integer_within<int>(v.front(), 1, 1000);
     },
     [](const Study& s) { return one(s.access_repeats); }},
    {"probe_grid", whole, 1, "",
     "n: delta_R and what is coarser than asked are taken at the centres of n x n x n cells, and "
     "access timed in their order",
     [](Study& s, const SettingValues& v) {
         s.probe_grid = integer_within<int>(v.front(), 1, 300);
     },
     [](const Study& s) { return one(s.probe_grid); }},
    {"fine_probe_grid", whole, 1, "",
     "The same for the finer probes of delta_R_fine and coarser_fine",
     [](Study& s, const SettingValues& v) {
         s.fine_probe_grid = integer_within<int>(v.front(), 1, 300);
     },
     [](const Study& s) { return one(s.fine_probe_grid); }},
    {"reference_tolerance", number_type, 1, "",
     "Exact reference: pass over anisotropic sources that would shorten a length by less than this "
     "fraction t; errs by a delta of 2 t^2 or so, and takes less time [1]",
     [](Study& s, const SettingValues& v) {
         s.reference_tolerance = within(number(v.front()), 0, 0.1);
     },
     [](const Study& s) { return one(s.reference_tolerance); }},
    {"output", text_type, 1, "", "New folder for the results; left out: results/NAME-DATE-TIME",
     [](Study& s, const SettingValues& v) { s.output = text(v.front()); },
     [](const Study& s) { return s.output.empty() ? SettingValues{} : SettingValues{s.output}; }},
};

const Setting<Run> run_table[] = {
    {"structures", text_type, 0, "",
     "Structures (see `controlspace list`), or all, trees, anchored, baselines",
     [](Run& r, const SettingValues& v) { fill(r.structures, v, text); },
     [](const Run& r) {
         return SettingValues{r.structures.begin(), r.structures.end()};
     }},
    {"splits", text_type, 0, "", "Where kd-trees cut: s_L, s_G, s_Gx, s_M", set_names<&Run::splits>,
     get_names<&Run::splits>},
    {"rho", number_type, 0, "", "Spacing of sampled sources [h]", set_positive<&Run::rho>,
     get_numbers<&Run::rho>},
    {"tau", number_type, 0, "",
     "l_min: longest edge of the leaf of a source [metric length at the source]",
     set_positive<&Run::tau>, get_numbers<&Run::tau>},
    {"epsilon", number_type, 0, "", "Non-conformity below which a source is met already",
     set_positive<&Run::epsilon>, get_numbers<&Run::epsilon>},
    {"g_r", number_type, 0, "", "Gradation ratio, 1 or more",
     [](Run& r, const SettingValues& v) {
         fill(r.g_r, v, [](const SettingValue& x) { return within(number(x), 1, 1e6); });
     },
     get_numbers<&Run::g_r>},
    {"mmg_hgrad", number_type, 0, "g_r", "Gradation as MMG's -hgrad: g_r = 1 + ln(hgrad)",
     set_ratio_from<gradation_ratio_from_mmg>, none},
    {"refine_beta", number_type, 0, "g_r", "Gradation as refine's beta: g_r = 1 + ln(beta)",
     set_ratio_from<gradation_ratio_from_refine>, none},
    {"sampling", text_type, 0, "", "How sampled sources lie: regular, random, clustered, poisson",
     set_names<&Run::sampling>, get_names<&Run::sampling>},
    {"field", text_type, 0, "",
     "Continuous field that is asked for besides the sources: none, sphere, planes, ugawg-linear, "
     "ugawg-polar-1, ugawg-polar-2, file",
     set_names<&Run::field>, get_names<&Run::field>},
    {"s_a", number_type, 0, "", "Tangential length of sampled sources [h]", set_positive<&Run::s_a>,
     get_numbers<&Run::s_a>},
    {"s_n", number_type, 0, "", "Normal length of sampled sources [tangential length]",
     set_positive<&Run::s_n>, get_numbers<&Run::s_n>},
    {"kd_depth", whole, 0, "", "Deepest level of kd-trees, the root being 0",
     set_depths<&Run::kd_depth>, get_depths<&Run::kd_depth>},
    {"octree_depth", whole, 0, "", "Deepest level of octrees, the root being 0",
     set_depths<&Run::octree_depth>, get_depths<&Run::octree_depth>},
    {"voxel", number_type, 0, "",
     "Longest edge of a grid's finest voxels [length]; 0: tau times the smallest length asked for",
     set_not_negative<&Run::voxel>, get_numbers<&Run::voxel>},
    {"voxel_factor", number_type, 0, "",
     "c of grids in levels: longest edge of a voxel [metric length of the metric it holds]",
     set_positive<&Run::voxel_factor>, get_numbers<&Run::voxel_factor>},
    {"prune_delta", number_type, 0, "",
     "Non-conformity up to which OpenVDB grids join voxels once they are graded; 0: they do not",
     set_not_negative<&Run::prune_delta>, get_numbers<&Run::prune_delta>},
    {"target_delta", number_type, 0, "",
     "Non-conformity to the exact field that trees are adapted to, in place of insertion and "
     "gradation; 0: they are not",
     set_not_negative<&Run::target_delta>, get_numbers<&Run::target_delta>},
    {"equal_delta", number_type, 0, "",
     "Largest delta_R that a grid's voxels (in levels voxel_factor too; and prune_delta, where "
     "that "
     "saves memory) are chosen for; 0: as they are set. Trees have target_delta",
     set_not_negative<&Run::equal_delta>, get_numbers<&Run::equal_delta>},
    {"equal_memory", number_type, 0, "",
     "Memory of the finished grid that its voxels are chosen for [MB]; 0: as they are set",
     set_not_negative<&Run::equal_memory>, get_numbers<&Run::equal_memory>},
    {"node_values", text_type, 0, "",
     "What control nodes hold: graded, as gradation leaves them; exact, the reference there, which "
     "shows the error of interpolation alone",
     set_names<&Run::node_values>, get_names<&Run::node_values>},
    {"frozen", text_type, 0, "",
     "Whether the paper's trees are made compact and only read once they are finished, which is "
     "not "
     "timed: no; doubles, the same bits; floats, metrics rounded by 6e-8",
     set_names<&Run::frozen>, get_names<&Run::frozen>},
    {"law", text_type, 0, "", "Law of gradation: cone, mean-length", set_names<&Run::law>,
     get_names<&Run::law>},
    {"schedule", text_type, 0, "",
     "Order of gradation: queue, until nothing changes; passes, as in the paper's tables",
     set_names<&Run::schedule>, get_names<&Run::schedule>},
    {"neighbourhood", text_type, 0, "",
     "Nodes that gradation compares: faces, those across faces (at vertices: along edges) as in "
     "the "
     "paper; all, those across edges and corners too (at vertices: of the same leaf or voxel). "
     "K_LA, K_oLA, direct and adapted trees compare none",
     set_names<&Run::neighbourhood>, get_names<&Run::neighbourhood>},
    {"reference", text_type, 0, "", "Field to compare with: exact, published-sphere",
     set_names<&Run::reference>, get_names<&Run::reference>},
};

void require_type(ValueType type, const SettingValue& value) {
    const double* x = std::get_if<double>(&value);
    if (type == ValueType::text) {
        if (x != nullptr) throw InputError(fmt::format("{} is not a text", *x));
        return;
    }
    if (x == nullptr) throw InputError(fmt::format("'{}' is not a number", text(value)));
    if (!std::isfinite(*x)) throw InputError(fmt::format("{} is not a finite number", *x));
    if (type == ValueType::whole_number && *x != std::floor(*x)) {
        throw InputError(fmt::format("{} is not a whole number", *x));
    }
}

}  // namespace

std::span<const Setting<Study>> study_settings() {
    static const std::vector<Setting<Study>> all = [] {
        std::vector<Setting<Study>> settings(std::begin(general_table), std::end(general_table));
        for (const auto more : {field_settings(), file_settings(), vdb_settings()}) {
            settings.insert(settings.end(), more.begin(), more.end());
        }
        return settings;
    }();
    return all;
}
std::span<const Setting<Run>> run_settings() { return run_table; }

std::string to_string(const SettingValues& values) {
    std::vector<std::string> words;
    for (const SettingValue& value : values) {
        words.push_back(std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    }
    return fmt::format("{}", fmt::join(words, ", "));
}

void require_fit(ValueType type, std::size_t at_most, const SettingValues& values) {
    if (values.empty()) throw InputError("no value: give at least one");
    if (at_most > 0 && values.size() > at_most) {
        throw InputError(fmt::format("{} values: give {} at most", values.size(), at_most));
    }
    for (const SettingValue& value : values) require_type(type, value);
}

}  // namespace controlspace

#include "report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "report/style.h"
#include "study/settings.h"

namespace controlspace {
namespace {

double creation_s(const Measures& m) { return m.insert_s + m.gradation_s; }
double bytes(const Measures& m) { return static_cast<double>(m.footprint.bytes_total()); }
double largest_error(const Measures& m) { return m.accuracy_fine.max; }
double mean_error(const Measures& m) { return m.accuracy_fine.mean; }

/// A measure that is compared: by samples, or by one number.
struct Compared {
    std::string_view name;
    std::string_view less;  ///< what a smaller value is called
    std::string_view more;
    AccessTime Measures::*samples;
    double (*number)(const Measures&);
    std::string_view mark;  ///< gnuplot's
};
constexpr std::array compared{
    Compared{"access, random", "faster", "slower", &Measures::access_random, nullptr,
             "pointtype 7 linecolor rgb '#0072B2'"},
    Compared{"access, grid", "faster", "slower", &Measures::access_grid, nullptr,
             "pointtype 5 linecolor rgb '#E69F00'"},
    Compared{"creation", "faster", "slower", nullptr, creation_s,
             "pointtype 9 linecolor rgb '#009E73'"},
    Compared{"memory", "smaller", "larger", nullptr, bytes, "pointtype 13 linecolor rgb '#000000'"},
    Compared{"largest δ_R, fine", "more accurate", "less accurate", nullptr, largest_error,
             "pointtype 6 linecolor rgb '#D55E00'"},
    Compared{"mean δ_R, fine", "more accurate", "less accurate", nullptr, mean_error,
             "pointtype 4 linecolor rgb '#CC79A7'"}};

/// None where one of two numbers is 0, and the other is not.
std::optional<NoisyRatio> ratio_of(const Compared& c, const RowPair& pair) {
    const Measures& before = *pair.before->measures;
    const Measures& after = *pair.after->measures;
    if (c.samples != nullptr) return access_ratio(before.*c.samples, after.*c.samples);
    const double a = c.number(before);
    const double b = c.number(after);
    if (a == b) return NoisyRatio{};
    if (!(a > 0) || !(b > 0) || !std::isfinite(a) || !std::isfinite(b)) return std::nullopt;
    return NoisyRatio{b / a, b / a, b / a};
}

/// Pairs by setting, in their order.
std::vector<std::pair<std::string, std::vector<RowPair>>> by_setting(
    std::span<const RowPair> pairs) {
    std::vector<std::pair<std::string, std::vector<RowPair>>> groups;
    for (const RowPair& pair : pairs) {
        const std::string label = setting_label(pair.before->setting);
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const auto& known) { return known.first == label; });
        if (group == groups.end()) group = groups.insert(group, {label, {}});
        group->second.push_back(pair);
    }
    return groups;
}

std::string ratio_text(const Compared& c, const std::optional<NoisyRatio>& ratio) {
    if (!ratio) return "–";
    if (c.samples == nullptr) return fmt::format("{:.3f}", ratio->value);
    return fmt::format("{:.3f} ({:.3f} to {:.3f}){}", ratio->value, ratio->low, ratio->high,
                       ratio->is_within_noise() ? "" : " *");
}

Figure change_figure(const std::string& setting, const std::vector<RowPair>& pairs) {
    Figure figure;
    figure.title = "After over before: " + setting;
    figure.caption =
        "Left of 1: faster, smaller, more accurate. Bars of access times reach from the lower "
        "quartile of the later samples over the upper one of the earlier to the reverse: what "
        "crosses 1 may be noise. Creation times are of one run each.";
    figure.height = height_of(pairs.size(), 34);
    Range x;
    x.add(1);
    std::string names, plots;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        names += fmt::format("{}{} {}", i == 0 ? "" : ", ",
                             gnuplot_string(structure_label(pairs[i].before->setting)),
                             pairs.size() - i);
    }
    for (std::size_t k = 0; k < compared.size(); ++k) {
        figure.data += fmt::format("$measure{} << EOD\n", k);
        const double offset = 0.35 - 0.14 * static_cast<double>(k);
        bool any = false;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const auto ratio = ratio_of(compared[k], pairs[i]);
            if (!ratio) continue;
            any = true;
            x.add(ratio->low);
            x.add(ratio->high);
            figure.data +=
                fmt::format("{} {} {} {}\n", static_cast<double>(pairs.size() - i) + offset,
                            ratio->value, ratio->low, ratio->high);
        }
        figure.data += "EOD\n";
        if (!any) continue;
        plots +=
            fmt::format("{}$measure{} using 2:1:3:4 with xerrorbars pointsize 0.7 {} title '{}'",
                        plots.empty() ? "plot " : ", ", k, compared[k].mark, compared[k].name);
    }
    figure.commands =
        log_axis("x", x, "after / before") +
        fmt::format("set ytics ({}) scale 0\nset yrange [0.4:{}.6]\n", names, pairs.size()) +
        "set arrow from 1, graph 0 to 1, graph 1 nohead linecolor rgb '#888888'\n"
        "set key outside right top Left reverse samplen 1\nset grid xtics linecolor rgb "
        "'#dddddd'\nset bmargin 5\n" +
        plots + "\nunset arrow\n";
    return figure;
}

}  // namespace

std::vector<RowPair> row_pairs(std::span<const Row> before, std::span<const Row> after) {
    std::vector<RowPair> pairs;
    std::vector<char> taken(after.size(), 0);
    for (const Row& row : before) {
        if (!row.measures) continue;
        for (std::size_t i = 0; i < after.size(); ++i) {
            if (taken[i] != 0 || !after[i].measures || after[i].setting != row.setting ||
                after[i].sources != row.sources) {
                continue;
            }
            taken[i] = 1;
            pairs.push_back({&row, &after[i]});
            break;
        }
    }
    return pairs;
}

std::string differing_settings(const Study& before, const Study& after) {
    std::string text;
    for (const Setting<Study>& setting : study_settings()) {
        const SettingValues a = setting.get(before);
        const SettingValues b = setting.get(after);
        if (a == b || setting.key == "name" || setting.key == "output") continue;
        const auto shown = [](const SettingValues& values) {
            return values.empty() ? "not set" : to_string(values);
        };
        text += fmt::format("{}{} {}, then {}", text.empty() ? "" : "; ", setting.key, shown(a),
                            shown(b));
    }
    return text;
}

NoisyRatio access_ratio(const AccessTime& before, const AccessTime& after) {
    return {after.median_ns() / before.median_ns(), after.quartile_ns(1) / before.quartile_ns(3),
            after.quartile_ns(3) / before.quartile_ns(1)};
}

TextTable change_counts(std::span<const RowPair> pairs) {
    TextTable table{"What changed",
                    "Numbers of rows; a change of access times counts where the quartiles of the "
                    "samples lie apart. Creation is timed once a row: its counts are of noise too.",
                    {{"measure", Align::left}, {"better"}, {"the same"}, {"worse"}, {"no ratio"}},
                    {}};
    for (const Compared& c : compared) {
        std::size_t better = 0, same = 0, worse = 0, none = 0;
        for (const RowPair& pair : pairs) {
            const auto ratio = ratio_of(c, pair);
            ++(!ratio ? none : ratio->is_within_noise() ? same : ratio->value < 1 ? better : worse);
        }
        table.rows.push_back({std::string(c.name), fmt::format("{} {}", better, c.less),
                              fmt::format("{}", same), fmt::format("{} {}", worse, c.more),
                              fmt::format("{}", none)});
    }
    return table;
}

std::vector<TextTable> change_tables(std::span<const RowPair> pairs) {
    std::vector<TextTable> tables;
    for (const auto& [setting, members] : by_setting(pairs)) {
        TextTable& table = tables.emplace_back(
            TextTable{"After / before: " + setting,
                      "In brackets: from the quotients of opposite quartiles of the samples; * "
                      "where they do not hold 1.",
                      {{"structure", Align::left}},
                      {}});
        for (const Compared& c : compared) table.columns.push_back({std::string(c.name)});
        for (const RowPair& pair : members) {
            auto& row = table.rows.emplace_back(std::vector{structure_label(pair.before->setting)});
            for (const Compared& c : compared) row.push_back(ratio_text(c, ratio_of(c, pair)));
        }
    }
    return tables;
}

std::vector<Figure> change_figures(std::span<const RowPair> pairs, const std::string& prefix,
                                   const std::string& made_by) {
    std::vector<Figure> figures;
    for (const auto& [setting, members] : by_setting(pairs)) {
        Figure figure = change_figure(setting, members);
        figure.name = fmt::format("{}change-{:02}", prefix, figures.size() + 1);
        figure.made_by = made_by;
        figures.push_back(std::move(figure));
    }
    return figures;
}

}  // namespace controlspace

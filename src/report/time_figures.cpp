#include "report/time_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "study/names.h"

namespace controlspace {
namespace {

/// Rows that belong into one picture, by a key of theirs, in the order of the rows.
template <class Key, class KeyOf>
std::vector<std::pair<Key, std::vector<const Row*>>> grouped(std::span<const Row> rows,
                                                             KeyOf&& key_of) {
    std::vector<std::pair<Key, std::vector<const Row*>>> groups;
    for (const Row& row : rows) {
        if (!row.measures) continue;
        Key key = key_of(row.setting);
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const auto& known) { return known.first == key; });
        if (group == groups.end()) group = groups.insert(group, {std::move(key), {}});
        group->second.push_back(&row);
    }
    return groups;
}

/// How one kind of access is drawn.
struct AccessKind {
    std::string_view name;
    std::string_view title;
    AccessTime Measures::*time;
    double above;  ///< the row's line, in units of the distance of lines
    std::string_view colour;
};
constexpr AccessKind access_kinds[] = {
    {"random", "at random places", &Measures::access_random, 0.2, "#0072B2"},
    {"grid", "in order of a grid", &Measures::access_grid, -0.2, "#E69F00"}};

Figure access_figure(const std::string& setting, const std::vector<const Row*>& rows) {
    Figure figure;
    figure.title = "Access time: " + setting;
    figure.caption =
        "Boxes hold the middle half of the samples, with the median as a line; whiskers reach to "
        "the fastest and slowest sample; dots are the samples. Each is the mean of a batch.";
    figure.height = height_of(rows.size(), 26);
    constexpr double half_height = 0.17;
    Range x;
    std::string plots;
    for (const AccessKind& kind : access_kinds) {
        std::string boxes, samples;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const AccessTime& time = (*rows[i]->measures).*kind.time;
            const double y = static_cast<double>(rows.size() - i) + kind.above;
            const auto [low, high] =
                std::minmax_element(time.samples_ns.begin(), time.samples_ns.end());
            boxes += fmt::format("{} {} {} {} {} {} {}\n", y, *low, time.quartile_ns(1),
                                 time.median_ns(), time.quartile_ns(3), *high,
                                 gnuplot_cell(structure_label(rows[i]->setting)));
            for (const double sample : time.samples_ns) {
                samples += fmt::format("{} {}\n", y, sample);
                x.add(sample);
            }
        }
        figure.data += fmt::format("${0} << EOD\n{1}EOD\n${0}_samples << EOD\n{2}EOD\n", kind.name,
                                   boxes, samples);
        plots += fmt::format(
            "{4}${0} using 2:1:($6-$2):(0) with vectors nohead linecolor rgb '{2}' notitle, "
            "${0} using 4:1:3:5:($1-{1}):($1+{1}) with boxxyerror fillstyle solid 0.4 "
            "linecolor rgb '{2}' title '{3}', "
            "${0} using 4:($1-{1}):(0):(2*{1}) with vectors nohead linewidth 2 linecolor rgb "
            "'{2}' notitle, "
            "${0}_samples using 2:1 with points pointtype 7 pointsize 0.25 linecolor rgb "
            "'#000000' notitle",
            kind.name, half_height, kind.colour, kind.title, plots.empty() ? "plot " : ", ");
    }
    std::string names;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        names += fmt::format("{}{} {}", i == 0 ? "" : ", ",
                             gnuplot_string(structure_label(rows[i]->setting)), rows.size() - i);
    }
    figure.commands =
        log_axis("x", x, "access time [ns/query]") +
        fmt::format("set ytics ({}) scale 0\nset yrange [0.4:{}.6]\n", names, rows.size()) +
        "set key outside top center horizontal\nset grid xtics linecolor rgb "
        "'#dddddd'\nset bmargin 5\n" +
        plots + "\n";
    return figure;
}

/// What rows of one picture of creation times share.
Case without_density(const Case& c) {
    Case shared = c;
    const Case any;
    shared.sources.rho = 0;
    shared.structure = "";
    shared.split = any.split;
    shared.max_depth = any.max_depth;
    shared.voxel = any.voxel;
    shared.voxel_factor = any.voxel_factor;
    return shared;
}

/// All but the density of sources that setting_label would name.
std::string title_of(const Case& c) {
    return fmt::format("tau {}, epsilon {}, g_r {}; {} law, {}", c.tau, c.epsilon, c.g_r,
                       name_of(c.law), name_of(c.schedule));
}

Figure creation_figure(const Case& shared, const std::vector<const Row*>& rows,
                       const Styles& styles) {
    Figure figure;
    figure.title = "Creation time against sources: " + title_of(shared);
    figure.caption =
        "Insertion and gradation together, on one thread. Marks are rows; lines join those of one "
        "structure: solid with s_L and without a split, dashed with s_G, dotted with s_M.";
    Range x, y;
    std::string plots;
    std::vector<std::pair<std::string, std::string>> series;  // label, lines
    std::vector<const Case*> first;
    std::set<std::string> named;
    for (const Row* row : rows) {
        const double seconds = row->measures->insert_s + row->measures->gradation_s;
        const auto sources = static_cast<double>(row->sources);
        x.add(sources);
        y.add(seconds);
        const std::string label = structure_label(row->setting);
        auto found = std::find_if(series.begin(), series.end(),
                                  [&](const auto& s) { return s.first == label; });
        if (found == series.end()) {
            found = series.insert(found, {label, ""});
            first.push_back(&row->setting);
        }
        found->second += fmt::format("{} {} {}\n", row->sources, seconds, gnuplot_cell(label));
    }
    for (std::size_t i = 0; i < series.size(); ++i) {
        figure.data += fmt::format("$points{} << EOD\n{}EOD\n", i, series[i].second);
        const bool in_key = named.insert(first[i]->structure).second;
        plots +=
            fmt::format("{}$points{} using 1:2 with linespoints {} {} {}", i == 0 ? "plot " : ", ",
                        i, Styles::dashes(*first[i]), styles.mark(*first[i]),
                        in_key ? "title " + gnuplot_string(first[i]->structure) : "notitle");
    }
    figure.commands = log_axis("x", x, "sources") + log_axis("y", y, "creation time [s]") +
                      "set key outside right top Left reverse samplen 1\n"
                      "set grid linecolor rgb '#dddddd'\nset bmargin 5\n" +
                      plots + "\n";
    return figure;
}

}  // namespace

std::vector<Figure> access_figures(std::span<const Row> rows, const std::string& prefix,
                                   const std::string& made_by) {
    std::vector<Figure> figures;
    for (const auto& [setting, members] : grouped<std::string>(rows, setting_label)) {
        Figure figure = access_figure(setting, members);
        figure.name = fmt::format("{}access-{:02}", prefix, figures.size() + 1);
        figure.made_by = made_by;
        figures.push_back(std::move(figure));
    }
    return figures;
}

std::vector<Figure> creation_figures(std::span<const Row> rows, const Styles& styles,
                                     const std::string& prefix, const std::string& made_by) {
    std::vector<Figure> figures;
    for (const auto& [shared, members] : grouped<Case>(rows, without_density)) {
        const std::size_t fewest = members.front()->sources;
        const bool varies = std::any_of(members.begin(), members.end(),
                                        [&](const Row* row) { return row->sources != fewest; });
        if (!varies) continue;
        Figure figure = creation_figure(shared, members, styles);
        figure.name = fmt::format("{}creation-{:02}", prefix, figures.size() + 1);
        figure.made_by = made_by;
        figures.push_back(std::move(figure));
    }
    return figures;
}

}  // namespace controlspace

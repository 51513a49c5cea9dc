#include "report/pareto_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "study/pareto.h"

namespace controlspace {
namespace {

constexpr double mb = 1e6;

/// Points of one structure: a datablock, and a line of the key.
struct Series {
    const Case* first;
    std::string lines;
};

/// Series in the order in which structures occur; `lines_of(point)` are added to the point's.
template <class Points, class CaseOf, class LineOf>
std::vector<Series> series_of(const Points& points, CaseOf&& case_of, LineOf&& line_of) {
    std::vector<Series> series;
    for (const auto& point : points) {
        const Case& c = case_of(point);
        auto found = std::find_if(series.begin(), series.end(), [&](const Series& s) {
            return s.first->structure == c.structure;
        });
        if (found == series.end()) found = series.insert(found, {&c, ""});
        found->lines += line_of(point);
    }
    return series;
}

std::string datablock(std::string_view name, std::string_view lines) {
    return fmt::format("${} << EOD\n{}EOD\n", name, lines);
}

/// Points of a front whose labels do not lie over each other.
std::vector<ParetoPoint> apart(const std::vector<ParetoPoint>& front, const Range& x,
                               const Range& y, double unit) {
    constexpr double width = 0.25, height = 0.04;  // of a label, in units of the axes
    const auto place = [](double value, const Range& range) {
        const double extent = std::log(range.high / range.low);
        return extent > 0 ? std::log(std::max(value, range.low) / range.low) / extent : 0;
    };
    std::vector<ParetoPoint> chosen;
    for (const ParetoPoint& p : front) {
        const bool free = std::none_of(chosen.begin(), chosen.end(), [&](const ParetoPoint& q) {
            return std::abs(place(p.cost / unit, x) - place(q.cost / unit, x)) < width &&
                   std::abs(place(p.error, y) - place(q.error, y)) < height;
        });
        if (free) chosen.push_back(p);
    }
    return chosen;
}

Figure pareto_figure(const ParetoPlot& plot, std::span<const Row> rows, const Styles& styles) {
    const bool by_bytes = plot.cost == ParetoCost::bytes;
    const bool largest = plot.error == ParetoError::max;
    const double unit = by_bytes ? mb : 1;
    Figure figure;
    figure.title = fmt::format("{} error against {}: {}", largest ? "Largest" : "Mean",
                               by_bytes ? "memory" : "access time", plot.work);
    figure.caption = fmt::format(
        "Below and to the left is better. The line is the front: for rows on it, no other is at "
        "most as large in both. Where labels would lie over each other, one is left out: the table "
        "below has all. Rows with an error below {} stand at the lower edge.",
        smallest_drawn_error);
    Range x, y;
    for (const ParetoPoint& p : plot.points) {
        x.add(p.cost / unit);
        y.add(std::max(p.error, smallest_drawn_error));
    }
    const auto line = [&](const ParetoPoint& p) {
        return fmt::format("{} {} {}\n", p.cost, p.error,
                           gnuplot_cell(pareto_label(rows[p.row].setting)));
    };
    const auto series = series_of(
        plot.points, [&](const ParetoPoint& p) -> const Case& { return rows[p.row].setting; },
        line);
    std::vector<ParetoPoint> front;
    std::copy_if(plot.points.begin(), plot.points.end(), std::back_inserter(front),
                 [](const ParetoPoint& p) { return p.on_front; });
    std::sort(front.begin(), front.end(),
              [](const ParetoPoint& a, const ParetoPoint& b) { return a.cost < b.cost; });
    std::string front_lines, labels;
    for (const ParetoPoint& p : front) front_lines += line(p);
    for (const ParetoPoint& p : apart(front, x, y, unit)) labels += line(p);
    figure.data = datablock("front", front_lines) + datablock("labels", labels);
    // Labels stand to the left of their points, where nothing else is.
    x.add(x.low * std::pow(x.low / x.high, 0.2));

    const std::string columns = fmt::format("($1/{}):($2 > {} ? $2 : {})", unit,
                                            smallest_drawn_error, smallest_drawn_error);
    figure.commands =
        log_axis("x", x, by_bytes ? "memory [MB]" : "access at random places [ns/query]") +
        log_axis("y", y,
                 largest ? "largest δ_R at the finer probes" : "mean δ_R at the finer probes") +
        "set key outside right top Left reverse samplen 1\nset grid linecolor rgb '#dddddd'\n"
        "set bmargin 5\n" +
        fmt::format(
            "plot $front using {} with steps linecolor rgb '#888888' linewidth 2 title "
            "'front'",
            columns);
    for (std::size_t i = 0; i < series.size(); ++i) {
        figure.data += datablock(fmt::format("points{}", i), series[i].lines);
        figure.commands +=
            fmt::format(", $points{} using {} with points {} pointsize 1.1 title {}", i, columns,
                        styles.mark(*series[i].first), gnuplot_string(series[i].first->structure));
    }
    figure.commands += fmt::format(
        ", $labels using {}:3 with labels right offset -0.7,-0.7 font ',8' notitle\n", columns);
    return figure;
}

using PaperPoint = PaperEvidence::Cell;

Figure paper_figure(double rho, const std::vector<PaperPoint>& points, const Styles& styles) {
    Figure figure;
    figure.title = fmt::format("Largest δ_R against size, ours and the paper's: ρ {}", rho);
    figure.caption =
        "Tables 1 and 4 at once, size as the paper counts it, δ_R at 30 x 30 x 30 places. Filled "
        "or open marks with colour: ours; crosses: the paper's, with a line to ours.";
    Range x, y;
    for (const PaperPoint& p : points) {
        const Measures& m = *p.ours->measures;
        x.add(static_cast<double>(*m.footprint.bytes_published) / mb);
        x.add(p.paper->size_mb);
        y.add(m.accuracy.max);
        y.add(p.paper->delta_r_max);
    }
    const auto series = series_of(
        points, [](const PaperPoint& p) -> const Case& { return p.ours->setting; },
        [](const PaperPoint& p) {
            const Measures& m = *p.ours->measures;
            return fmt::format("{} {} {} {} {}\n", *m.footprint.bytes_published, m.accuracy.max,
                               p.paper->size_mb, p.paper->delta_r_max,
                               gnuplot_cell(pareto_label(p.ours->setting)));
        });
    figure.commands = log_axis("x", x, "size in the paper's accounting [MB]") +
                      log_axis("y", y, "largest δ_R") +
                      "set key outside right top Left reverse samplen 1\n"
                      "set grid linecolor rgb '#dddddd'\nset bmargin 5\nplot ";
    for (std::size_t i = 0; i < series.size(); ++i) {
        figure.data += datablock(fmt::format("points{}", i), series[i].lines);
        figure.commands += fmt::format(
            "$points{0} using ($1/{1}):2:($3-$1/{1}):($4-$2) with vectors nohead linecolor rgb "
            "'#aaaaaa' notitle, $points{0} using 3:4 with points pointtype 2 {6} {2}, "
            "$points{0} using ($1/{1}):2 with points {3} pointsize 1.1 title {4}{5}",
            i, mb, i == 0 ? "title 'paper'" : "notitle", styles.mark(*series[i].first),
            gnuplot_string(series[i].first->structure), i + 1 < series.size() ? ", " : "\n",
            styles.colour(*series[i].first));
    }
    return figure;
}

}  // namespace

std::vector<Figure> pareto_figures(std::span<const Row> rows, const Styles& styles,
                                   const std::string& prefix, const std::string& made_by) {
    std::vector<Figure> figures;
    for (const ParetoPlot& plot : pareto_plots(rows)) {
        Figure figure = pareto_figure(plot, rows, styles);
        figure.name = fmt::format("{}pareto-{:02}", prefix, figures.size() + 1);
        figure.made_by = made_by;
        figures.push_back(std::move(figure));
    }
    return figures;
}

std::vector<Figure> paper_figures(const PaperEvidence& evidence, const Styles& styles,
                                  const std::string& prefix, const std::string& made_by) {
    std::map<double, std::vector<PaperPoint>> by_density;
    for (const PaperPoint& cell : evidence.cells()) {
        if (!cell.ours->measures || !cell.ours->measures->footprint.bytes_published) continue;
        by_density[cell.paper->rho].push_back(cell);
    }
    std::vector<Figure> figures;
    for (const auto& [rho, points] : by_density) {
        Figure figure = paper_figure(rho, points, styles);
        figure.name = fmt::format("{}paper-{:02}", prefix, figures.size() + 1);
        figure.made_by = made_by;
        figures.push_back(std::move(figure));
    }
    return figures;
}

}  // namespace controlspace

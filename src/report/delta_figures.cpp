#include "report/delta_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controlspace/metric/nonconformity.h"
#include "measure/percentile.h"
#include "report/colours.h"
#include "report/style.h"

namespace controlspace {
namespace {

std::vector<double> deltas(const FieldSample& a, const FieldSample& b) {
    std::vector<double> values;
    for (std::size_t i = 0; i < a.probes.size(); ++i) {
        const double delta = nonconformity(a.probes[i], b.probes[i]);
        // What is no metric is as wrong as can be.
        values.push_back(std::isnan(delta) ? std::numeric_limits<double>::infinity() : delta);
    }
    return values;
}

/// Percentiles of δ that are shown.
struct Spread {
    double p95 = 0, p99 = 0, max = 0;
};
Spread spread_of(std::vector<double> values) {
    return {percentile(values, 95), percentile(values, 99), percentile(values, 100)};
}

std::string label_of(const FieldSample& sample) {
    return sample.row == nullptr ? "exact" : structure_label(sample.row->setting);
}

/// Shares of `values` in bins of equal width on a logarithmic axis; the first and the last take
/// what lies beyond.
struct Histogram {
    static constexpr double low = smallest_drawn_error;
    static constexpr double high = 20;
    static constexpr int bins = 60;

    std::vector<double> shares = std::vector<double>(bins, 0.0);

    explicit Histogram(const std::vector<double>& values) {
        for (const double value : values) {
            const double place =
                std::log(std::clamp(value, low, high) / low) / std::log(high / low);
            const int bin = std::clamp(static_cast<int>(place * bins), 0, bins - 1);
            shares[static_cast<std::size_t>(bin)] += 1.0 / static_cast<double>(values.size());
        }
    }
    static double edge(int bin) { return low * std::pow(high / low, bin / double{bins}); }
};

}  // namespace

Figure delta_histograms(const SampledFields& fields, const std::string& name,
                        const std::string& made_by) {
    const auto n = fields.structures.size();
    Figure figure;
    figure.name = name;
    figure.title =
        "Error δ over the domain: " + setting_label(fields.structures.front().row->setting);
    figure.caption = fmt::format(
        "Share of the probes in each of {} classes, as wide as each other on this axis; every "
        "structure's largest class has the same height. Marks: 95th percentile (bar), 99th "
        "(circle) "
        "and maximum (cross). Errors below {} stand at the left edge.",
        Histogram::bins, smallest_drawn_error);
    figure.made_by = made_by;
    figure.height = height_of(n, 40);
    figure.data = "$marks << EOD\n";
    std::string histograms, plots, names;
    for (std::size_t i = 0; i < n; ++i) {
        const auto values = deltas(fields.structures[i], fields.exact);
        const Spread spread = spread_of(values);
        const double base = static_cast<double>(n - i);
        figure.data += fmt::format("{} {} {} {} {}\n", base, spread.p95, spread.p99, spread.max,
                                   gnuplot_cell(label_of(fields.structures[i])));
        const Histogram histogram(values);
        const double most = *std::max_element(histogram.shares.begin(), histogram.shares.end());
        histograms += fmt::format("$histogram{} << EOD\n", i);
        for (int bin = 0; bin < Histogram::bins; ++bin) {
            const double share = histogram.shares[static_cast<std::size_t>(bin)];
            for (const int side : {0, 1}) {
                histograms += fmt::format("{:.6g} {} {:.6g} {:.6g}\n", Histogram::edge(bin + side),
                                          base, base + 0.8 * share / most, share);
            }
        }
        histograms += "EOD\n";
        plots += fmt::format(
            "$histogram{} using 1:2:3 with filledcurves fillcolor rgb '#56B4E9' "
            "notitle, ",
            i);
        names += fmt::format("{}{} {}", i == 0 ? "" : ", ",
                             gnuplot_string(label_of(fields.structures[i])), base + 0.2);
    }
    figure.data += "EOD\n" + histograms;
    const auto drawn = [](int column) {
        return fmt::format("(${0} > {1} ? ${0} : {1})", column, smallest_drawn_error);
    };
    figure.commands =
        log_axis("x", {Histogram::low, Histogram::high}, "δ to the exact field") +
        fmt::format(
            "set ytics ({}) scale 0\nset yrange [0.8:{}]\nset key outside top center "
            "horizontal\nset bmargin 5\nset grid xtics linecolor rgb '#dddddd'\nplot {}",
            names, n + 1, plots) +
        fmt::format(
            "$marks using ({0}):1:(0):(0.5) with vectors nohead linewidth 2 linecolor rgb "
            "'#000000' title '95th percentile', ",
            drawn(2)) +
        fmt::format(
            "$marks using ({0}):($1+0.25) with points pointtype 6 linecolor rgb '#D55E00' "
            "title '99th percentile', ",
            drawn(3)) +
        fmt::format(
            "$marks using ({0}):($1+0.25) with points pointtype 2 linecolor rgb '#D55E00' "
            "title 'maximum'\n",
            drawn(4));
    return figure;
}

TextTable delta_table(const SampledFields& fields) {
    TextTable table{
        "Error δ over the domain",
        "At the probes of δ_R, of structures made anew for this report; in brackets what was "
        "stored when the rows were measured.",
        {{"structure", Align::left}, {"95th percentile"}, {"99th percentile"}, {"maximum"}},
        {}};
    for (const FieldSample& sample : fields.structures) {
        const Spread now = spread_of(deltas(sample, fields.exact));
        const Accuracy& then = sample.row->measures->accuracy;
        const auto cell = [](double a, double b) { return fmt::format("{:.4f} ({:.4f})", a, b); };
        table.rows.push_back({label_of(sample), cell(now.p95, then.p95), cell(now.p99, then.p99),
                              cell(now.max, then.max)});
    }
    return table;
}

Figure cross_validation(const SampledFields& fields, const std::string& name,
                        const std::string& made_by) {
    std::vector<const FieldSample*> all{&fields.exact};
    for (const FieldSample& sample : fields.structures) all.push_back(&sample);
    Figure figure;
    figure.name = name;
    figure.title =
        "Structures against each other: " + setting_label(fields.structures.front().row->setting);
    figure.caption =
        "δ between the answers of two structures at the probes of δ_R: structures that share "
        "nothing but the sources agree where both are right. Left: 95th percentile; right: "
        "maximum.";
    figure.made_by = made_by;
    figure.data = "$pairs << EOD\n";
    std::string names;
    std::size_t longest_name = 0;
    const std::size_t n = all.size();
    std::vector<Spread> spreads(n * n);
    for (std::size_t a = 0; a < n; ++a) {
        const std::string label = label_of(*all[a]);
        longest_name = std::max(longest_name, label.size());
        names += fmt::format("{}{} {}", a == 0 ? "" : ", ", gnuplot_string(label), a);
        for (std::size_t b = 0; b < a; ++b) {
            spreads[a * n + b] = spreads[b * n + a] = spread_of(deltas(*all[a], *all[b]));
        }
    }
    for (std::size_t i = 0; i < spreads.size(); ++i) {
        figure.data += fmt::format("{} {} {} {}\n", i / n, i % n, spreads[i].p95, spreads[i].max);
    }
    figure.data += "EOD\n";
    // In pixels: gnuplot would shrink the cells to nothing beside long names.
    const double side = std::clamp(40.0 * static_cast<double>(n), 240.0, 6000.0);
    const double names_width = 8 + 7.5 * static_cast<double>(longest_name);
    const double panel_width = names_width + 1.08 * side + 70;  // with the colours' bar
    const double names_height = 30 + 0.65 * names_width;
    figure.width = static_cast<int>(2 * panel_width);
    figure.height = static_cast<int>(80 + side + names_height + 30);  // titles, the command
    const auto panel = [&](double left, int column, std::string_view title) {
        const double bottom = names_height + 30;
        // Light numbers on dark cells.
        return fmt::format(
            "set lmargin at screen {3:.5f}\nset rmargin at screen {4:.5f}\n"
            "set bmargin at screen {5:.5f}\nset tmargin at screen {6:.5f}\n"
            "set title '{1}'\nplot $pairs using 1:2:(${0} > {2} ? ${0} : {2}) with image pixels, "
            "$pairs using 1:2:(sprintf(${0} > 0 && ${0} < 0.01 ? '%.0e' : '%.2g', ${0})):"
            "(${0} > 0.05 ? 0xffffff : 0x000000) with labels font ',7' textcolor rgb variable\n",
            column, title, smallest_drawn_error, (left + names_width) / figure.width,
            (left + names_width + side) / figure.width, bottom / figure.height,
            (bottom + side) / figure.height);
    };
    figure.commands =
        fmt::format(
            "set multiplot title {}\nunset key\n"
            "set logscale cb\nset cbrange [{}:10]\nset format cb '%g'\n"
            "set xrange [-0.5:{}.5]\nset yrange [{}.5:-0.5]\n"
            "set xtics ({}) rotate by 45 right scale 0\nset ytics ({}) scale 0\n",
            gnuplot_title(figure.title), smallest_drawn_error, n - 1, n - 1, names, names) +
        std::string(error_palette) + panel(0, 3, "δ, 95th percentile") + "unset label 999\n" +
        panel(panel_width, 4, "δ, maximum") + "unset multiplot\n";
    return figure;
}

}  // namespace controlspace

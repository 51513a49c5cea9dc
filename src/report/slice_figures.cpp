#include "report/slice_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "controlspace/metric/nonconformity.h"
#include "report/colours.h"
#include "report/style.h"

namespace controlspace {
namespace {

using Values = std::vector<double>;

Values mean_lengths(const std::vector<Metric>& metrics) {
    Values values;
    std::transform(metrics.begin(), metrics.end(), std::back_inserter(values), mean_length);
    return values;
}

Values anisotropies(const std::vector<Metric>& metrics) {
    Values values;
    for (const Metric& m : metrics) {
        const auto lengths = eigen_frame(m).lengths;
        values.push_back(lengths[2] / lengths[0]);
    }
    return values;
}

Values errors(const std::vector<Metric>& a, const std::vector<Metric>& b) {
    Values values;
    std::transform(a.begin(), a.end(), b.begin(), std::back_inserter(values), nonconformity);
    return values;
}

/// A matrix of a slice as a datablock: a line for each y.
std::string matrix_block(std::string_view name, const Values& values) {
    std::string text = fmt::format("${} << EOD\n", name);
    for (std::size_t i = 0; i < values.size(); ++i) {
        text += fmt::format("{:.4g}{}", values[i], (i + 1) % slice_cells == 0 ? '\n' : ' ');
    }
    return text + "EOD\n";
}

/// The lower and left sides of the elements: with the frame around, all of them.
std::string outline_block(const std::vector<Box>& elements) {
    std::string text = "$outlines << EOD\n";
    for (const Box& e : elements) {
        text += fmt::format("{0:.6g} {3:.6g}\n{0:.6g} {1:.6g}\n{2:.6g} {1:.6g}\n\n", e.low.x(),
                            e.low.y(), e.high.x(), e.high.y());
    }
    return text + "EOD\n";
}

/// Draws panels of one slice.
class Panels {
public:
    explicit Panels(const Box& domain) : domain_(domain) {}

    std::string frame() const {
        return fmt::format(
            "set size ratio -1\nset xrange [{}:{}]\nset yrange [{}:{}]\nset xtics out nomirror "
            "autofreq\nset ytics out nomirror autofreq\nset xlabel 'x [length]'\nset ylabel 'y "
            "[length]'\n"
            "unset key\n",
            domain_.low.x(), domain_.high.x(), domain_.low.y(), domain_.high.y());
    }

    std::string panel(std::string_view block, std::string_view title, const Range& colours,
                      std::string_view quantity, bool outlined) const {
        const Vector cell = domain_.edges() / slice_cells;
        const double high = std::max(colours.high, 1.01 * colours.low);
        return fmt::format(
            "set title {}\nset logscale cb\nset cbrange [{:.6g}:{:.6g}]\nset "
            "cbtics {}\n"
            "plot ${} matrix using ({}+($1+0.5)*{}):({}+($2+0.5)*{}):3 with image{}\n",
            gnuplot_string(fmt::format("{}: {}", title, quantity)), colours.low, high,
            log_tics(colours.low, high), block, domain_.low.x(), cell.x(), domain_.low.y(),
            cell.y(),
            outlined ? ", $outlines using 1:2 with lines linewidth 0.4 linecolor rgb '#80ffffff'"
                     : "");
    }

private:
    Box domain_;
};

Range range_of(const Values& values) {
    Range range;
    for (const double value : values) range.add(value);
    return range;
}

/// A ratio below which lengths in different directions are the same to the eye.
constexpr double visible_anisotropy = 1.01;

}  // namespace

std::vector<Figure> slice_figures(const SampledFields& fields, const std::string& prefix,
                                  const std::string& made_by) {
    const Values exact_lengths = mean_lengths(fields.exact.slice);
    const Values exact_anisotropies = anisotropies(fields.exact.slice);
    const Range lengths = range_of(exact_lengths);
    const Range ratios = range_of(exact_anisotropies);
    const bool anisotropic = ratios.high > visible_anisotropy;
    constexpr Range deltas{smallest_drawn_error, 10};
    const Panels panels(fields.domain);
    std::vector<Figure> figures;
    for (const FieldSample& sample : fields.structures) {
        Figure figure;
        figure.name = fmt::format("{}slice-{:02}", prefix, figures.size() + 1);
        figure.title =
            fmt::format("Slice at z = {:.4g}, {}: {}", fields.z,
                        structure_label(sample.row->setting), setting_label(sample.row->setting));
        figure.caption = fmt::format(
            "{} from the left: the exact field, {}'s{}, and the error δ between them; the colours "
            "are those of the exact field's range. {}",
            anisotropic ? "Mean length (anisotropy below it)" : "Mean length",
            structure_label(sample.row->setting),
            sample.elements ? " with its elements" : " (its elements are too many to be drawn)",
            anisotropic ? "" : "All lengths at a place are the same: there is no anisotropy.");
        figure.made_by = made_by;
        figure.width = 1200;
        figure.height = anisotropic ? 820 : 450;
        figure.raster = true;

        Values delta = errors(sample.slice, fields.exact.slice);
        for (double& d : delta) d = std::max(d, smallest_drawn_error);
        figure.data = matrix_block("exact", exact_lengths) +
                      matrix_block("lengths", mean_lengths(sample.slice)) +
                      matrix_block("delta", delta);
        if (sample.elements) figure.data += outline_block(*sample.elements);
        const bool outlined = sample.elements.has_value();
        const std::string label = structure_label(sample.row->setting);
        figure.commands =
            fmt::format("set multiplot layout {} title {}\n",
                        anisotropic ? "2,3 margins 0.06,0.92,0.12,0.86 spacing 0.12,0.14"
                                    : "1,3 margins 0.06,0.92,0.21,0.8 spacing 0.12,0.1",
                        gnuplot_title(figure.title)) +
            panels.frame() + std::string(viridis_palette) +
            panels.panel("exact", "exact", lengths, "h_mean [length]", false) +
            "unset label 999\n" +
            panels.panel("lengths", label, lengths, "h_mean [length]", outlined) +
            std::string(error_palette) + panels.panel("delta", "error", deltas, "δ", false);
        if (anisotropic) {
            figure.data += matrix_block("exact_ratio", exact_anisotropies) +
                           matrix_block("ratio", anisotropies(sample.slice));
            figure.commands += std::string(viridis_palette) +
                               panels.panel("exact_ratio", "exact", ratios, "anisotropy", false) +
                               panels.panel("ratio", label, ratios, "anisotropy", outlined);
        }
        figure.commands += "unset multiplot\n";
        figures.push_back(std::move(figure));
    }
    return figures;
}

}  // namespace controlspace

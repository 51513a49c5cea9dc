#include "report/sampled_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "controlspace/error.h"
#include "controlspace/measure/accuracy.h"
#include "study/run.h"

namespace controlspace {
namespace {

/// More outlines would cover what they lie on.
constexpr std::size_t most_elements = 20000;

std::vector<Point> slice_places(const Box& domain, double z) {
    const Vector cell = domain.edges() / slice_cells;
    std::vector<Point> places;
    for (int j = 0; j < slice_cells; ++j) {
        for (int i = 0; i < slice_cells; ++i) {
            places.emplace_back(domain.low.x() + (i + 0.5) * cell.x(),
                                domain.low.y() + (j + 0.5) * cell.y(), z);
        }
    }
    return places;
}

std::vector<Metric> sampled(const ControlSpace& space, std::span<const Point> places) {
    std::vector<Metric> metrics(places.size());
    space.sample(places, metrics);
    return metrics;
}

/// Makes the structure of `row`, or says why not.
std::unique_ptr<ControlSpace> make_again(const Study& study, const Row& row,
                                         std::span<const CatalogueEntry> catalogue,
                                         const Workload& workload, std::string& why_not) {
    if (row.measures->insert_s + row.measures->gradation_s > longest_creation_s) {
        why_not = fmt::format("took longer than {} s to make", longest_creation_s);
        return nullptr;
    }
    const CatalogueEntry* entry = find_entry(catalogue, row.setting.structure);
    if (entry == nullptr) {
        why_not = "this program has no such structure";
        return nullptr;
    }
    try {
        Measures ignored;
        return make_and_fill(study, row.setting, *entry, workload, ignored, {});
    } catch (const std::bad_alloc&) {
        why_not = "out of memory";
    } catch (const InputError& error) {
        why_not = error.what();
    }
    return nullptr;
}

}  // namespace

std::optional<std::vector<Box>> elements_on_slice(const ControlSpace& space, double z,
                                                  std::size_t most) {
    const Box& domain = space.domain();
    const Vector inside = 1e-9 * domain.edges();
    std::vector<Box> elements;
    // Rows of elements from below: none ends between one row's height and the next, so that each
    // element is met at its lower side.
    for (double y = domain.low.y(); y < domain.high.y() - inside.y();) {
        double next_y = domain.high.y();
        for (double x = domain.low.x(); x < domain.high.x() - inside.x();) {
            const Box element = space.element_at({x + inside.x(), y + inside.y(), z});
            if (element.low.y() >= y - inside.y()) elements.push_back(element);
            if (elements.size() > most) return std::nullopt;
            next_y = std::min(next_y, element.high.y());
            x = std::max(element.high.x(), x + inside.x());
        }
        y = std::max(next_y, y + inside.y());
    }
    return elements;
}

std::vector<const Row*> first_setting(std::span<const Row> rows) {
    std::vector<const Row*> chosen;
    for (const Row& row : rows) {
        if (!row.measures) continue;
        const bool fits = chosen.empty() ||
                          (setting_label(row.setting) == setting_label(chosen.front()->setting) &&
                           row.setting.sources == chosen.front()->setting.sources &&
                           std::none_of(chosen.begin(), chosen.end(), [&](const Row* other) {
                               return other->setting.structure == row.setting.structure;
                           }));
        if (fits) chosen.push_back(&row);
    }
    return chosen;
}

SampledFields sample_fields(const Study& study, std::span<const Row* const> rows,
                            std::span<const CatalogueEntry> catalogue, const FileReaders& readers) {
    if (rows.empty()) throw InputError("no row has measures: run a study whose cases do not fail");
    const Case& first = rows.front()->setting;
    const Workload workload = make_workload(study, first.sources, readers);
    const auto reference = make_reference(study, first, workload);
    SampledFields fields;
    fields.domain = workload.domain;
    fields.z = workload.domain.centre().z();
    const std::vector<Point> slice = slice_places(fields.domain, fields.z);
    const std::vector<Point> probes = cell_centres(fields.domain, study.probe_grid);
    fields.exact.slice.resize(slice.size());
    fields.exact.probes.resize(probes.size());
    reference->evaluate(slice, fields.exact.slice);
    reference->evaluate(probes, fields.exact.probes);
    for (const Row* row : rows) {
        std::string why_not;
        const auto space = make_again(study, *row, catalogue, workload, why_not);
        if (!space) {
            fields.left_out.push_back(
                fmt::format("{}: {}", structure_label(row->setting), why_not));
            continue;
        }
        fields.structures.push_back({row, sampled(*space, slice), sampled(*space, probes),
                                     elements_on_slice(*space, fields.z, most_elements)});
    }
    return fields;
}

}  // namespace controlspace

#include "controlspace/sources/source_columns.h"

#include <algorithm>

#include "refuse.h"

namespace controlspace {

void SourceColumns::add(std::span<const PointSource> sources) {
    const auto is_isotropic = [](const PointSource& s) {
        return controlspace::is_isotropic(s.metric);
    };
    const bool are_lengths = metrics_.empty() && std::ranges::all_of(sources, is_isotropic);
    if (!are_lengths && metrics_.empty()) {
        for (const double h : lengths_) metrics_.push_back(Metric::isotropic(h));
        lengths_ = std::vector<double>();  // its memory too
    }
    if (positions_.empty()) {
        positions_.reserve(sources.size());
        are_lengths ? lengths_.reserve(sources.size()) : metrics_.reserve(sources.size());
    }
    for (const PointSource& source : sources) {
        growths_.add(positions_.size(), source.growth);
        positions_.push_back(source.position);
        if (are_lengths) {
            lengths_.push_back(source.metric.xx);
        } else {
            metrics_.push_back(source.metric);
        }
    }
}

std::vector<PointSource> SourceColumns::part(std::size_t first, std::size_t count) const {
    std::vector<PointSource> sources(std::min(count, size() - first));
    for (std::size_t i = 0; i < sources.size(); ++i) sources[i] = (*this)[first + i];
    return sources;
}

std::size_t SourceColumns::bytes() const {
    return positions_.capacity() * sizeof(Point) + lengths_.capacity() * sizeof(double) +
           metrics_.capacity() * sizeof(Metric) + growths_.bytes();
}

SourceColumns columns_of(std::span<const PointSource> sources) {
    SourceColumns columns;
    columns.add(sources);
    return columns;
}

double finest_length(const SourceColumns& sources) {
    if (!sources.are_isotropic()) return finest_length(sources.all());
    if (sources.empty()) refuse("no sources: give at least one");
    return std::ranges::min(sources.lengths());
}

}  // namespace controlspace

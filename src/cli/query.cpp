#include "cli/query.h"

#include <vector>

#include "cli/filled_space.h"
#include "cli/step_progress.h"
#include "io/text/csv.h"

namespace controlspace {

void query(const QueryOptions& options) {
    const std::vector<Point> places = read_csv_points(options.points);
    std::vector<Metric> metrics(places.size());
    {
        StepProgress progress(options.quiet, options.output);
        const FilledSpace filled =
            filled_space(options.input, options.settings, progress.observer());
        progress.started("sampling");
        filled.space->sample(places, metrics);
    }
    std::vector<PointSource> answers(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) answers[i] = {places[i], metrics[i]};
    write_csv_sources(options.output, answers);
}

}  // namespace controlspace

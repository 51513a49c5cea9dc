#include "app/query.h"

#include <vector>

#include "app/input_study.h"
#include "app/readers.h"
#include "app/threads.h"
#include "baselines/catalogue.h"
#include "sources/csv.h"
#include "study/run.h"

namespace controlspace {

void query(const QueryOptions& options) {
    const std::vector<Point> places = read_csv_points(options.points);
    const Study study = study_of_input(options.input, options.settings);
    const auto threads = limit_threads(study.threads);
    const Case c = only_case(study);
    const Workload workload = make_workload(study, c.sources, file_readers());
    Measures unused;
    const auto space = make_and_fill(study, c, entry_of(c, structures()), workload, unused, {});
    std::vector<Metric> metrics(places.size());
    space->sample(places, metrics);
    std::vector<PointSource> answers(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) answers[i] = {places[i], metrics[i]};
    write_csv_sources(options.output, answers);
}

}  // namespace controlspace

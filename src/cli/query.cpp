// The command `query`: writes the metrics of one structure at given points.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/query_pipe.h"
#include "cli/standard_output.h"
#include "controlspace/error.h"
#include "io/text/csv.h"

namespace controlspace {
namespace {

struct Query {
    std::filesystem::path input, points, output = "/dev/stdout";
    bool pipe = false;
    WordsByKey given;
    bool quiet = false;
};

int answer_pipe(const Query& job) {
    if (!job.points.empty()) throw InputError("--pipe reads the points: leave out POINTS");
    const GivenSettings given = given_settings(job.given);
    const auto files = is_control_space(job.input)
                           ? std::vector{job.input}
                           : files_of(study_of_input(job.input, given).sources);
    if (std::ranges::count(files, std::filesystem::path("/dev/stdin")) > 0) {
        throw InputError("--pipe reads the points from standard input: name a file of sources");
    }
    FilledSpace filled;
    {
        StepProgress progress(job.quiet, {});
        filled = filled_space(job.input, {}, given, progress.observer());
    }
    const int status = report_remark(filled);
    answer_places(*filled.space);
    return status;
}

int query(const Query& job) {
    if (job.pipe) return answer_pipe(job);
    if (job.points.empty()) {
        throw InputError("no POINTS: name a .csv, or give --pipe (see controlspace query --help)");
    }
    require_no_input(job.output, {job.input, job.points});
    if (is_control_space(job.output)) {
        throw InputError(
            fmt::format("{}: metrics are written as .csv: name such a file", job.output.string()));
    }
    const std::vector<Point> points = read_csv_points(job.points);
    std::vector<Metric> metrics(points.size());
    FilledSpace filled;
    {
        StepProgress progress(job.quiet, job.output);
        filled =
            filled_space(job.input, job.output, given_settings(job.given), progress.observer());
        progress.started("sampling");
        filled.space->sample(points, metrics);
    }
    std::vector<PointSource> answers(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) answers[i] = {points[i], metrics[i]};
    write_csv_sources(job.output, answers);
    const Box domain = filled.space->domain();
    const auto outside =
        std::ranges::count_if(points, [&](const Point& p) { return !domain.contains(p); });
    if (outside > 0) {
        print_error(
            fmt::format("{} of {} points are outside the domain {}: they have the metric of its "
                        "nearest point\n",
                        outside, points.size(), to_string(domain)));
    }
    return report_remark(filled);
}

}  // namespace

Action add_query(Options& options) {
    const auto job = std::make_shared<Query>();
    add_filled_input(options, job->input, true);
    options.add({"POINTS", "FILE.csv", "Points: columns x, y and z; other columns are ignored"},
                job->points);
    options.add({"-o,--output", "FILE.csv",
                 "File to write: x,y,z,h, or the components of M; left out: standard output"},
                job->output);
    options.add({"--pipe", "",
                 "In place of POINTS: answer places on standard input by lengths on standard "
                 "output, as Gmsh's field ExternalProcess asks: three doubles in, one out, in "
                 "binary; NaN ends"},
                job->pipe);
    options.exclude("--pipe", "--output");
    add_making_options(options, job->given);
    add_quiet(options, job->quiet);
    return [job](const std::string&) { return query(*job); };
}

}  // namespace controlspace

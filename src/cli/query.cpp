// SPDX-License-Identifier: Apache-2.0
// The command `query`: writes the metrics of one structure at given points.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <system_error>
#include <vector>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/standard_output.h"
#include "controlspace/space/sample_parallel.h"
#include "io/text/csv.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

using Place = std::array<double, 3>;

[[noreturn]] void fail(const char* what) {
    refuse("{}: {}", what, std::generic_category().message(errno));
}

/// What is there to read, and at least one byte; 0 at the end.
std::size_t read_some(std::span<char> bytes) {
    for (;;) {
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count >= 0) return static_cast<std::size_t>(count);
        if (errno != EINTR) fail("standard input cannot be read");
    }
}

void write_all(std::span<const double> lengths) {
    auto bytes = std::as_bytes(lengths);
    while (!bytes.empty()) {
        const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR) fail("standard output cannot be written");
        if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
}

/// Answers places on standard input by lengths on standard output, as Gmsh's field ExternalProcess
/// asks: three doubles in, one out, in the machine's own bytes; each as soon as it can be read. A
/// NaN or the end of input ends it. Throws InputError where the input breaks off within a place, or
/// if reading or writing fails.
void answer_places(const ControlSpace& space) {
    constexpr std::size_t at_once = 4096;
    std::vector<char> bytes(at_once * sizeof(Place));
    std::vector<Point> places;
    std::vector<double> lengths;
    std::size_t filled = 0;
    while (const std::size_t count = read_some(std::span(bytes).subspan(filled))) {
        filled += count;
        places.clear();
        bool ends = false;
        std::size_t used = 0;
        for (; !ends && filled - used >= sizeof(Place); used += sizeof(Place)) {
            Place x;
            std::memcpy(x.data(), bytes.data() + used, sizeof x);
            const Point place(x.data());
            ends = place.hasNaN();
            if (!ends) places.push_back(place);
        }
        lengths.resize(places.size());
        space.sample_lengths(places, lengths);
        write_all(lengths);
        if (ends) return;
        std::memmove(bytes.data(), bytes.data() + used, filled - used);
        filled -= used;
    }
    if (filled > 0) {
        refuse("the last place has {} of {} bytes: send three doubles for each", filled,
               sizeof(Place));
    }
}

struct Query : Job {
    std::filesystem::path points;
    bool pipe = false;
};

int answer_pipe(const Query& job) {
    if (!job.points.empty()) refuse("--pipe reads the points: leave out POINTS");
    const auto files = is_control_space(job.input)
                           ? std::vector{job.input}
                           : study_of_input(job.input, given_settings(job.given)).sources.files;
    if (std::ranges::count(files, std::filesystem::path("/dev/stdin")) > 0) {
        refuse("--pipe reads the points from standard input: name a file of sources");
    }
    const FilledSpace filled = filled_space(job, "starting", [](const auto&, auto&) {});
    const int status = report_remark(filled);
    answer_places(*filled.space);
    return status;
}

int query(const Query& job) {
    if (job.pipe) return answer_pipe(job);
    if (job.points.empty()) {
        refuse("no POINTS: name a .csv, or give --pipe (see controlspace query --help)");
    }
    require_output(job.output, {job.input, job.points});
    if (is_control_space(job.output)) {
        refuse_at(job.output, "metrics are written as .csv: name such a file");
    }
    const std::vector<Point> points = read_csv_points(job.points);
    std::vector<Metric> metrics(points.size());
    const FilledSpace filled = filled_space(job, "sampling", [&](const auto& made, auto&) {
        sample_parallel(*made.space, points, metrics);
    });
    write_csv_sources(job.output, sources_from(points, metrics));
    report_outside(points, "points", filled.space->domain());
    return report_remark(filled);
}

}  // namespace

Action add_query(Options& options) {
    const auto job = std::make_shared<Query>();
    job->output = "/dev/stdout";
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
    add_making_options(options, *job);
    return [job](const std::string&) { return query(*job); };
}

}  // namespace controlspace

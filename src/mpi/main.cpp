// SPDX-License-Identifier: Apache-2.0
// The program controlspace-mpi: commands of `controlspace`, on all ranks of an MPI job.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/formats.h"
#include "cli/help.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/paper_reference.h"
#include "cli/peak_memory.h"
#include "cli/standard_output.h"
#include "cli/threads.h"
#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "io/text/csv.h"
#include "io/text/metric_rows.h"
#include "mpi/distributed_space.h"
#include "mpi/exchange.h"
#include "mpi/read_part.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// What a command is given.
struct ParallelJob : Job {
    std::filesystem::path points;
    int octants = 128;
};

/// The structure of all ranks, with the study that it was made for.
struct Made {
    Study study;
    std::unique_ptr<DistributedSpace> space;
};

void require_possible(const Case& c) {
    if (has_field(c.sources)) {
        refuse("ranks build fields of point sources: leave out primitives and --field");
    }
    if (c.law != GradationLaw::cone || c.schedule != GradationSchedule::sources) {
        refuse("ranks grade by the sources: leave out --law and --schedule");
    }
    if (c.max_leaves && *c.max_leaves != default_max_leaves)
        refuse("ranks have no limit of leaves: leave out --max-leaves");
    if (c.precision && *c.precision != StoredIn::doubles && *c.precision != StoredIn::as_made) {
        refuse("ranks build trees in doubles: leave out --precision");
    }
}

/// This rank's share of the sources. Of one .csv it reads no more than that.
Workload read_share(Ranks& ranks, const Study& study, const Case& c) {
    Workload workload;
    const auto& files = c.sources.files;
    const bool is_by_parts = c.sources.kind == SourcesKind::file && files.size() == 1 &&
                             lower_case_extension(files.front()) == ".csv" &&
                             std::filesystem::is_regular_file(files.front()) &&
                             c.sources.h_min == 0 && c.sources.h_max == largest_magnitude;
    ranks.together([&] {
        if (is_by_parts) {
            workload.sources = columns_of(read_csv_part(files.front(), ranks.rank(), ranks.size()));
            return;
        }
        workload = make_workload(study, c.sources, file_readers());
        const auto border = [&](int r) {
            return workload.sources.size() * static_cast<std::size_t>(r) /
                   static_cast<std::size_t>(ranks.size());
        };
        const std::size_t first = border(ranks.rank());
        workload.sources =
            columns_of(workload.sources.part(first, border(ranks.rank() + 1) - first));
    });
    if (!is_by_parts) return workload;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> ends(6, infinity);  // the lowest coordinates, and the highest's negatives
    for (const Point& position : workload.sources.positions()) {
        for (std::size_t a = 0; a < 3; ++a) {
            const double x = position[static_cast<Axis>(a)];
            ends[a] = std::min(ends[a], x);
            ends[a + 3] = std::min(ends[a + 3], -x);
        }
    }
    ranks.reduce(ends, MPI_MIN);
    ranks.together([&] {
        const std::vector<Point> corners{{ends[0], ends[1], ends[2]},
                                         {-ends[3], -ends[4], -ends[5]}};
        workload.domain = study.domain ? *study.domain : bounding_box(corners, study.margin);
    });
    return workload;
}

/// One source of each rank that has some, a tensor if it has one.
Workload one_of_each(Ranks& ranks, const SourceColumns& sources) {
    std::vector<PointSource> one;
    if (!sources.empty()) {
        const auto tensor = std::ranges::find_if_not(sources.metrics(), is_isotropic);
        const auto i = sources.are_isotropic() ? 0 : tensor - sources.metrics().begin();
        one.push_back(sources[static_cast<std::size_t>(i)]);
    }
    Workload some;
    some.sources = columns_of(ranks.gather(one).values);
    return some;
}

Made make(Ranks& ranks, const ParallelJob& job) {
    const GivenSettings given = given_settings(job.given);
    Made made;
    Case c;
    ranks.together([&] {
        made.study = study_of_input(job.input, given);
        c = only_case(made.study);
        require_possible(c);
    });
    // Ranks share the processors.
    const auto threads = limit_threads(made.study.threads == 0 ? 1 : made.study.threads);
    restart_peak_memory();
    Workload workload = read_share(ranks, made.study, c);
    DistributedOptions options;
    const Workload some = one_of_each(ranks, workload.sources);
    ranks.together([&] {
        DefaultTarget(job.input, given).set(c, some);
        options = {.structure = c.structure,
                   .space = space_options(made.study, c, workload),
                   .target = c.target_delta,
                   .octants_per_rank = static_cast<std::uint64_t>(std::max(job.octants, 0))};
    });
    const auto sources = std::exchange(workload.sources, {}).all();
    made.space = std::make_unique<DistributedSpace>(ranks.comm(), sources, options);
    return made;
}

/// As JSON, on rank 0.
std::string report_text(Ranks& ranks, const DistributedSpace& space) {
    const RankReport r = space.report();
    const std::string own = fmt::format(
        "{{\"given\": {}, \"owned\": {}, \"kept\": {}, \"received\": {}, \"octants\": {}, "
        "\"octants_of_all\": {}, \"leaves\": {}, \"bytes_sent\": {}, \"messages_sent\": {}, "
        "\"cpu_s\": {:.4f}, \"peak_bytes\": {}}}\n",
        r.given, r.owned, r.kept, r.received, r.octants, r.octants_of_all, r.leaves, r.bytes_sent,
        r.messages_sent, r.cpu_s, peak_memory());
    const auto all = ranks.gather(std::vector<char>(own.begin(), own.end())).values;
    std::string text = "[" + std::string(all.begin(), all.end() - 1) + "]\n";
    for (std::size_t i = text.find('\n'); i + 2 < text.size(); i = text.find('\n', i + 2)) {
        text.insert(i, ",");
    }
    return text;
}

int remark(const Ranks& ranks, const DistributedSpace& space) {
    const RankReport report = space.report();
    if (report.has_tensors && ranks.rank() == 0) {
        print_error(
            "tensors: metrics are those of another number of ranks up to the tolerance of their "
            "field, and not to the bit\n");
    }
    if (report.met) return 0;
    if (ranks.rank() == 0) {
        print_error(fmt::format("target missed: {}\n", report.remark));
    }
    return some_failed;
}

int build(Ranks& ranks, const ParallelJob& job) {
    const Made made = make(ranks, job);
    const std::string text = report_text(ranks, *made.space);
    ranks.together([&] {
        if (ranks.rank() == 0) print_to(job.output, text);
    });
    return remark(ranks, *made.space);
}

int export_pieces(Ranks& ranks, const ParallelJob& job) {
    const std::string ending = lower_case_extension(job.output);
    if (ending != ".pctrl" && ending != ".pvtu") {
        throw InputError(fmt::format("{}: name a .pctrl or a .pvtu", job.output.string()));
    }
    const Made made = make(ranks, job);
    if (ending == ".pctrl") {
        made.space->save(job.output);
    } else {
        made.space->write_leaves(job.output);
    }
    return remark(ranks, *made.space);
}

int print_checksum(Ranks& ranks, const ParallelJob& job) {
    const Made made = make(ranks, job);
    const std::uint64_t sum = made.space->checksum(made.study.access_points, made.study.seed);
    if (ranks.rank() == 0) print(fmt::format("checksum: {:016x}\n", sum));
    return remark(ranks, *made.space);
}

int sample(Ranks& ranks, const ParallelJob& job) {
    std::vector<Point> points;
    ranks.together([&] {
        require_output(job.output, {job.input, job.points});
        if (ranks.rank() == 0) points = read_csv_points(job.points);
    });
    const Made made = make(ranks, job);
    std::vector<Metric> metrics(points.size());
    made.space->sample(points, metrics);
    ranks.together([&] {
        if (ranks.rank() == 0) write_csv_sources(job.output, sources_from(points, metrics));
    });
    return remark(ranks, *made.space);
}

struct CommandRow {
    const char* name;
    const char* description;
    int (*run)(Ranks&, const ParallelJob&);
};
constexpr CommandRow commands[] = {
    {"build", "Build one structure, and write what each rank held, sent and took, as JSON", build},
    {"export",
     "Write it in pieces, one a rank: the index FILE.pctrl, which controlspace query, export and "
     "mesh read, or FILE.pvtu, the leaves for ParaView",
     export_pieces},
    {"checksum", "Print the checksum of its metrics at the study's random places", print_checksum},
    {"sample", "Write its metrics at given points", sample},
};

int run(Ranks& ranks, int argc, const char* const* argv) {
    CLI::App app(
        "Builds a control space, K_oL, K_oV or K_oLB, on all ranks of an MPI job: of lengths with "
        "the same bits for any number of ranks, of tensors with the same metrics up to the "
        "tolerance of their field.",
        "controlspace-mpi");
    app.require_subcommand(1);
    app.footer(
        "Examples:\n"
        "  mpirun -n 4 controlspace-mpi checksum sources.csv --structures K_oL\n"
        "  mpirun -n 4 controlspace-mpi sample sources.csv places.csv -o metrics.csv\n"
        "  mpirun -n 4 controlspace-mpi export sources.csv -o field.pctrl\n");
    set_help(app);
    std::vector<ParallelJob> jobs(std::size(commands));
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        CLI::App* command = app.add_subcommand(commands[i].name, commands[i].description);
        Options options(*command);
        ParallelJob& job = jobs[i];
        job.output = "/dev/stdout";
        add_study_input(options, job.input);
        if (commands[i].run == sample) {
            options.add({"POINTS", "FILE.csv", "Points: columns x, y and z", "", true}, job.points);
        }
        if (commands[i].run != print_checksum) {
            const bool is_required = commands[i].run == export_pieces;
            options.add({"-o,--output", "FILE", "File to write", "", is_required}, job.output);
        }
        options.add({"--octants", "N",
                     "Octants with more sources than the mean of N a rank are cut further, to "
                     "share them out"},
                    job.octants);
        add_making_options(options, job);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        if (ranks.rank() == 0) print(app.help());
        return 0;
    } catch (const CLI::ParseError& error) {
        refuse("{} (see controlspace-mpi --help)", error.what());
    }
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        if (app.got_subcommand(commands[i].name)) return commands[i].run(ranks, jobs[i]);
    }
    return 0;
}

int run_ranks(int argc, const char* const* argv) {
    Ranks ranks(MPI_COMM_WORLD);
    try {
        return run(ranks, argc, argv);
    } catch (const InputError& error) {  // thrown by all ranks
        if (ranks.rank() == 0) {
            print_error(fmt::format("controlspace-mpi: error: {}\n", error.what()));
        }
        return 2;
    } catch (const std::exception& error) {  // by this one, perhaps
        print_error(
            fmt::format("controlspace-mpi: error: rank {}: {}\n", ranks.rank(), error.what()));
        MPI_Abort(MPI_COMM_WORLD, 1);
        return 1;
    }
}

}  // namespace
}  // namespace controlspace

int main(int argc, char** argv) {
    // Large arrays are returned to the system when they are freed: otherwise the C library keeps
    // those as large as others that were freed before.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
    MPI_Init(&argc, &argv);
    const int status = controlspace::run_ranks(argc, argv);
    MPI_Finalize();
    return status;
}

#include "cli/paper.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "cli/run_study.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "study/paper_evidence.h"
#include "study/paper_page.h"
#include "study/read_results.h"
#include "study/results.h"
#include "study/study_file.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

/// A built-in study of experiments, and where its results lie in the folder of the cells.
struct Experiments {
    std::string_view folder;
    std::string_view (*study_text)();
};
constexpr Experiments all_experiments[] = {{"experiments", experiments_study_text},
                                           {"tie-order-x", tie_order_x_study_text},
                                           {"tie-order-zx", tie_order_zx_study_text}};

Study built_in(std::string_view text) { return parse_study(text, "built-in study"); }

struct Findings {
    PaperEvidence evidence;
    std::vector<std::string> origins;  ///< of the evidence, a line each
    fs::path folder;                   ///< for the page
    bool all_measured = true;
};

void add(Findings& findings, const Study& study, std::span<const Row> rows,
         const Provenance& provenance, bool complete) {
    findings.evidence.add(study, rows);
    findings.origins.push_back(origin_text(provenance, complete));
    for (const Row& row : rows) findings.all_measured &= row.error.empty();
}

fs::path run(Findings& findings, const Study& study, const PaperOptions& options,
             Interruption& interruption) {
    const FinishedStudy finished =
        run_study(study, {options.command_line, options.quiet, {}}, interruption);
    add(findings, finished.study, finished.rows, finished.provenance, true);
    return finished.folder;
}

void read(Findings& findings, const fs::path& folder) {
    const StoredResults results = read_results(folder);
    if (!results.complete) {
        spdlog::warn("{}: the results are not complete: cases are missing", folder.string());
    }
    add(findings, results.study, results.rows, results.provenance, results.complete);
}

bool has_paper_cases(const Study& study) {
    const auto cases = expand(study, structures());
    return std::any_of(cases.begin(), cases.end(),
                       [](const Case& c) { return is_as_published(c) && paper_row(c) != nullptr; });
}

/// Leaves to each run of `study` the densities and τ at which there are cells, or close to which.
void keep_settings_of(const PaperEvidence& evidence, Study& study) {
    const auto cells = evidence.cells();
    const auto drop = [&](std::vector<double>& values, auto&& value_of) {
        std::erase_if(values, [&](double x) {
            return std::none_of(cells.begin(), cells.end(), [&](const PaperEvidence::Cell& cell) {
                return std::abs(x - value_of(*cell.paper)) <= 0.05 * x;
            });
        });
    };
    for (Run& run : study.runs) {
        drop(run.rho, [](const PaperRow& row) { return row.rho; });
        drop(run.tau, [](const PaperRow& row) { return row.tau; });
    }
}

/// Runs the experiments on the cells found so far whose results do not lie there yet.
void run_experiments(Findings& findings, const PaperOptions& options, Interruption& interruption) {
    if (findings.evidence.cells().empty()) return;
    for (const Experiments& experiments : all_experiments) {
        const fs::path folder = findings.folder / experiments.folder;
        if (fs::exists(folder / "results.json")) continue;
        Study study = built_in(experiments.study_text());
        keep_settings_of(findings.evidence, study);
        study.output = folder;
        run(findings, study, options, interruption);
    }
}

Study study_to_run(const PaperOptions& options) {
    if (options.inputs.empty()) {
        Study study = built_in(paper_study_text());
        if (!options.full) {
            for (Run& run : study.runs) std::erase_if(run.rho, [](double rho) { return rho < 1; });
        }
        return study;
    }
    Study study = read_study(options.inputs.front());
    if (!has_paper_cases(study)) {
        throw InputError(
            fmt::format("{}: has no case of the paper's tables: give law mean-length, schedule "
                        "passes, reference published-sphere and the paper's sphere",
                        options.inputs.front().string()));
    }
    return study;
}

Findings run_cells(const PaperOptions& options, Interruption& interruption) {
    Study study = study_to_run(options);
    if (!options.output.empty()) study.output = options.output;
    Findings findings;
    findings.folder = run(findings, study, options, interruption);
    return findings;
}

Findings read_cells(const PaperOptions& options) {
    Findings findings;
    findings.folder = options.inputs.front();
    for (const fs::path& folder : options.inputs) {
        read(findings, folder);
        for (const fs::path& nested : experiments_in(folder)) read(findings, nested);
    }
    if (findings.evidence.cells().empty()) {
        throw InputError(
            fmt::format("{}: no row was run as the paper's tables: give results of `controlspace "
                        "paper`, or of `controlspace compare --as-published`",
                        options.inputs.front().string()));
    }
    return findings;
}

/// Whether the inputs are folders of results.
bool are_folders(const PaperOptions& options) {
    const auto is_folder = [](const fs::path& path) { return fs::is_directory(path); };
    return options.inputs.size() > 1 ||
           std::any_of(options.inputs.begin(), options.inputs.end(), is_folder);
}

}  // namespace

std::vector<fs::path> experiments_in(const fs::path& folder) {
    std::vector<fs::path> found;
    for (const Experiments& experiments : all_experiments) {
        const fs::path nested = folder / experiments.folder;
        if (fs::exists(nested / "results.json")) found.push_back(nested);
    }
    return found;
}

bool paper(const PaperOptions& options) {
    const bool read_only = are_folders(options);
    if (options.full && !options.inputs.empty()) {
        throw InputError("--full is for the built-in studies: leave out the names");
    }
    if (read_only && !options.output.empty()) {
        throw InputError("--output is for what is run: leave it out with folders of results");
    }
    Interruption interruption;
    Findings findings = read_only ? read_cells(options) : run_cells(options, interruption);
    if (options.experiments || options.inputs.empty()) {
        run_experiments(findings, options, interruption);
    }
    write_paper_page(findings.folder, paper_page(findings.evidence, findings.origins));
    print(paper_summary(findings.evidence, TableStyle::terminal));
    print(
        fmt::format("\nEvery cell and experiment: {}\n", (findings.folder / "paper.md").string()));
    return findings.all_measured;
}

}  // namespace controlspace

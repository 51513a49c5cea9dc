#include "app/paper.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <string_view>

#include "app/run_study.h"
#include "app/signals.h"
#include "app/standard_output.h"
#include "baselines/catalogue.h"
#include "error.h"
#include "study/paper_evidence.h"
#include "study/paper_page.h"
#include "study/read_results.h"
#include "study/results.h"
#include "study/study_file.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

/// Where the results of the second built-in study lie, in the folder of the first.
constexpr std::string_view tie_order_folder = "tie-order";

struct Findings {
    PaperEvidence evidence;
    std::vector<std::string> origins;  ///< of the evidence, a line each
    fs::path folder;                   ///< for the page
};

bool has_paper_cases(const Study& study) {
    const auto cases = expand(study, structures());
    return std::any_of(cases.begin(), cases.end(),
                       [](const Case& c) { return is_as_published(c) && paper_row(c) != nullptr; });
}

/// Adds the paper's denser sources, 0.2 of the spacing, to every run.
void add_dense_sources(Study& study) {
    for (Run& run : study.runs) {
        const std::vector<double> sparse = run.rho;
        for (const double rho : sparse) run.rho.push_back(0.2 * rho);
    }
}

void add(Findings& findings, const FinishedStudy& finished) {
    findings.evidence.add(finished.study, finished.rows);
    findings.origins.push_back(origin_text(finished.provenance, true));
}

Findings run_built_in(const PaperOptions& options) {
    Study tables = parse_study(paper_study_text(), "built-in study");
    Study tie_order = parse_study(tie_order_study_text(), "built-in study");
    if (options.full) {
        add_dense_sources(tables);
        add_dense_sources(tie_order);
    }
    Interruption interruption;
    Findings findings;
    tables.output = options.output;
    const FinishedStudy finished =
        run_study(tables, options.command_line, options.quiet, interruption);
    add(findings, finished);
    findings.folder = finished.folder;
    tie_order.output = finished.folder / tie_order_folder;
    add(findings, run_study(tie_order, options.command_line, options.quiet, interruption));
    return findings;
}

Findings run_file(const PaperOptions& options) {
    Study study = read_study(options.inputs.front());
    if (!options.output.empty()) study.output = options.output;
    if (!has_paper_cases(study)) {
        throw InputError(
            fmt::format("{}: has no case of the paper's tables: give law mean-length, schedule "
                        "passes, reference published-sphere and the paper's sphere",
                        options.inputs.front().string()));
    }
    Interruption interruption;
    Findings findings;
    const FinishedStudy finished =
        run_study(study, options.command_line, options.quiet, interruption);
    add(findings, finished);
    findings.folder = finished.folder;
    return findings;
}

void read_folder(Findings& findings, const fs::path& folder) {
    const StoredResults results = read_results(folder);
    if (!results.complete) {
        spdlog::warn("{}: the results are not complete: cases are missing", folder.string());
    }
    findings.evidence.add(results.study, results.rows);
    findings.origins.push_back(origin_text(results.provenance, results.complete));
}

Findings read_folders(const PaperOptions& options) {
    Findings findings;
    for (const fs::path& folder : options.inputs) {
        read_folder(findings, folder);
        const fs::path nested = folder / tie_order_folder;
        if (fs::exists(nested / "results.json")) read_folder(findings, nested);
    }
    if (findings.evidence.cells().empty()) {
        throw InputError(
            fmt::format("{}: no row was run as the paper's tables: give results of `controlspace "
                        "paper`, or of `controlspace compare --as-published`",
                        options.inputs.front().string()));
    }
    findings.folder = options.inputs.front();
    return findings;
}

Findings find(const PaperOptions& options) {
    if (options.inputs.empty()) return run_built_in(options);
    if (options.full) throw InputError("--full is for the built-in studies: leave out the names");
    const auto is_folder = [](const fs::path& path) { return fs::is_directory(path); };
    const bool study_file = options.inputs.size() == 1 && !is_folder(options.inputs.front());
    if (study_file) return run_file(options);
    if (!options.output.empty()) {
        throw InputError("--output is for what is run: leave it out with folders of results");
    }
    return read_folders(options);
}

}  // namespace

void paper(const PaperOptions& options) {
    const Findings findings = find(options);
    write_paper_page(findings.folder, paper_page(findings.evidence, findings.origins));
    print(paper_summary(findings.evidence, TableStyle::terminal));
    print(
        fmt::format("\nEvery cell and experiment: {}\n", (findings.folder / "paper.md").string()));
}

}  // namespace controlspace

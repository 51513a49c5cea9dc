// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_apart.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "cli/filled_space.h"
#include "controlspace/error.h"
#include "controlspace/mesh/mesh_files.h"
#include "controlspace/space/control_space_file.h"
#include "files/child_process.h"
#include "files/output_file.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Files in the folder of a job.
constexpr const char *job_file = "job.json", *vertices_file = "vertices",
                     *triangles_file = "triangles", *mesh_file = "out.meshb",
                     *cost_file = "cost.json", *log_file = "log", *field_file = "field.ctrl";

using Question = std::array<double, 3>;  ///< a place
using Answer = std::array<double, 6>;    ///< the metric there; NaN: the field has failed

void write_text(const fs::path& path, const std::string& text) {
    OutputFile file(path);
    file.write(text);
    file.commit();
}

/// The bytes of rows of numbers.
template <class Row>
void write_rows(const fs::path& path, const std::vector<Row>& rows) {
    OutputFile file(path);
    file.write_raw(rows.data(), rows.size());
    file.commit();
}

template <class Row>
std::vector<Row> read_rows(const fs::path& path) {
    const std::string bytes = read_binary_file(path);
    std::vector<Row> rows(bytes.size() / sizeof(Row));
    std::copy_n(bytes.data(), rows.size() * sizeof(Row), reinterpret_cast<char*>(rows.data()));
    return rows;
}

std::array<double, 3> numbers_of(const Point& p) { return {p.x(), p.y(), p.z()}; }
Point point_of(const std::array<double, 3>& x) { return Point(x.data()); }

void write_job(const fs::path& folder, const Box& domain, const GmshOptions& options) {
    Json job{{"low", numbers_of(domain.low)},
             {"high", numbers_of(domain.high)},
             {"hxt", options.algorithm == GmshAlgorithm::hxt},
             {"threads", options.threads},
             {"max_tets", options.max_tets}};
    if (options.factor) job["factor"] = *options.factor;
    if (options.optimize) job["optimize"] = *options.optimize;
    if (options.part) {
        job["crease"] = options.part->crease;
        job["scale"] = options.part->scale;
        job["cad"] = options.part->cad.empty() ? "" : fs::absolute(options.part->cad).string();
        if (options.part->cad.empty()) {
            write_rows(folder / vertices_file, options.part->vertices);
            write_rows(folder / triangles_file, options.part->triangles);
        }
    }
    write_text(folder / job_file, job.dump());
}

GmshOptions options_of(const Json& job, const fs::path& folder) {
    GmshOptions options;
    options.algorithm = job.at("hxt").get<bool>() ? GmshAlgorithm::hxt : GmshAlgorithm::delaunay;
    options.threads = job.at("threads");
    options.max_tets = job.at("max_tets");
    options.reports = true;
    if (job.contains("factor")) options.factor = job.at("factor").get<double>();
    if (job.contains("optimize")) options.optimize = job.at("optimize").get<double>();
    if (job.contains("crease")) {
        const std::string cad = job.at("cad");
        Part part{.crease = job.at("crease"), .cad = cad, .scale = job.at("scale")};
        if (cad.empty()) {
            part.vertices = read_rows<Point>(folder / vertices_file);
            part.triangles = read_rows<Triangle>(folder / triangles_file);
        }
        options.part = std::make_shared<const Part>(std::move(part));
    }
    return options;
}

/// The field of the process that runs this one, at the other end of standard input.
class RemoteField final : public ControlSpace {
public:
    explicit RemoteField(const Box& domain) : domain_(domain) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Question question = numbers_of(x[i]);
            Answer m;
            if (::send(STDIN_FILENO, &question, sizeof question, MSG_NOSIGNAL) < 0 ||
                ::recv(STDIN_FILENO, &m, sizeof m, MSG_WAITALL) != sizeof m) {
                throw InputError("the process that has the field has ended");
            }
            out[i] = {m[0], m[1], m[2], m[3], m[4], m[5]};
        }
    }
    Box domain() const override { return domain_; }

private:
    Box domain_;
    mutable std::mutex mutex_;
};

/// Whether the field is now in a file, for the other process to load: asking this one costs some
/// microseconds a place. Exact fields and foreign systems cannot be saved.
bool save_field(const fs::path& folder, const ControlSpace& field) {
    if (!recipe_of(field)) return false;
    try {
        save_control_space(folder / field_file, field);
    } catch (const InputError&) {
        return false;
    }
    return true;
}

/// What went wrong in the other process, on one line.
std::string reason(const ChildOutcome& outcome, const fs::path& log, double time_limit_s) {
    constexpr std::size_t enough = 2;
    constexpr std::string_view error = "controlspace: error: ";
    std::string said = last_lines(log, 1);
    const bool is_ours = outcome.is_known && !outcome.timed_out && outcome.signal == 0;
    if (is_ours && said.starts_with(error)) return said.substr(error.size());
    said = last_lines(log, enough);
    // What the C++ library adds at the end tells less than Gmsh itself.
    said.resize(std::min(said.size(), said.find(" | terminate called")));
    std::string what = fmt::format("failed with status {}", outcome.status);
    if (!outcome.is_known) what = "was collected by another part of this program";
    if (outcome.signal != 0) what = fmt::format("was ended by signal {}", outcome.signal);
    if (outcome.timed_out) {
        what = fmt::format("took longer than {} s (--time-limit)", time_limit_s);
    }
    return fmt::format(
        "Gmsh {}: {}: try the other algorithm (--mesher), other lengths, or repair "
        "the part",
        what, said.empty() ? "it reported nothing" : said);
}

}  // namespace

MeshRun mesh_apart(const Box& domain, const ControlSpace& field, const GmshOptions& options,
                   const fs::path& folder, double time_limit_s) {
    const TemporaryFolder files(folder, "gmsh");
    write_job(files.path(), domain, options);
    const bool is_saved = save_field(files.path(), field);
    const std::unique_ptr<Cursor> cursor = field.cursor();
    std::exception_ptr failure;
    std::chrono::steady_clock::duration time{};
    const auto answer = [&](const std::byte* question, std::byte* to) {
        Question x;
        std::memcpy(x.data(), question, sizeof x);
        Answer numbers;
        numbers.fill(std::numeric_limits<double>::quiet_NaN());
        const auto start = std::chrono::steady_clock::now();
        try {
            const Metric m = cursor->metric_at(point_of(x));
            numbers = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
        } catch (...) {
            failure = std::current_exception();
        }
        time += std::chrono::steady_clock::now() - start;
        std::memcpy(to, numbers.data(), sizeof numbers);
    };
    const Conversation conversation{sizeof(Question), sizeof(Answer), answer};
    const fs::path log = files.path() / log_file;
    const ChildOutcome outcome =
        run_child({fs::read_symlink("/proc/self/exe").string(), gmsh_job, files.path().string()},
                  files.path(), log, time_limit_s, is_saved ? nullptr : &conversation);
    if (failure) std::rethrow_exception(failure);
    if (!outcome.succeeded()) throw InputError(reason(outcome, log, time_limit_s));
    MeshRun run;
    run.mesh = read_medit_mesh(files.path() / mesh_file);
    const Json cost = Json::parse(read_text_file(files.path() / cost_file));
    run.cost = {.seconds = cost.at("seconds"),
                .processor_seconds = cost.at("processor_seconds"),
                .queries = cost.at("queries"),
                .query_seconds = cost.at("query_seconds"),
                .peak_bytes = outcome.peak_bytes};
    if (!is_saved) {
        run.cost.query_seconds = std::chrono::duration<double>(time).count();
        run.cost.processor_seconds += run.cost.query_seconds;
    }
    run.anisotropic = cost.at("anisotropic");
    return run;
}

int run_gmsh_job(const fs::path& folder) {
    const Json job = Json::parse(read_text_file(folder / job_file));
    const Box domain{point_of(job.at("low")), point_of(job.at("high"))};
    const fs::path saved = folder / field_file;
    const std::unique_ptr<ControlSpace> field =
        fs::exists(saved) ? load_saved(saved) : std::make_unique<RemoteField>(domain);
    const MeshRun run = mesh_with_gmsh(domain, *field, options_of(job, folder));
    write_medit_mesh(folder / mesh_file, run.mesh);
    const Json cost{{"seconds", run.cost.seconds},
                    {"processor_seconds", run.cost.processor_seconds},
                    {"queries", run.cost.queries},
                    {"query_seconds", run.cost.query_seconds},
                    {"anisotropic", run.anisotropic}};
    write_text(folder / cost_file, cost.dump());
    return 0;
}

}  // namespace controlspace

// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_folder.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <utility>

#include "cli/mesh_field.h"
#include "cli/peak_memory.h"
#include "cli/standard_output.h"
#include "controlspace/study/results.h"

namespace controlspace {
namespace {

constexpr const char* results_file = "meshes.json";

}  // namespace

MeshFolder::MeshFolder(const Study& study, MeshSettings settings, const std::string& command_line,
                       bool quiet, Interruption& interruption)
    : study_(study),
      settings_(std::move(settings)),
      quiet_(quiet),
      interruption_(interruption),
      provenance_(current_provenance()) {
    provenance_.command_line = command_line;
    path_ = results_path(study, provenance_);
}

void MeshFolder::begin() {
    lock_.emplace(path_, /*make=*/true);
    make_results_folder(path_, results_file);
    record(false);
}

void MeshFolder::add(MeshRow row, const Box& domain, const ControlSpace& reference,
                     const std::function<const ControlSpace&(MeshRow&)>& field) {
    restart_peak_memory();
    try {
        const ControlSpace& meshed = field ? field(row) : reference;
        const TetMesh mesh = make_mesh(domain, meshed, settings_, path_, row);
        row.cost.peak_bytes = std::max(row.cost.peak_bytes, peak_memory());
        row.conformity = conformity(mesh, reference);
        // The structure's name; what follows, "δ <= 0.1", is in the table.
        const std::string label = mesh_label(row);
        std::string name = fmt::format("{:02}-{}", rows_.size(), label.substr(0, label.find(',')));
        const auto unfit = [](char c) { return c == ' ' || c == '/'; };
        std::replace_if(name.begin(), name.end(), unfit, '-');
        const auto whole = interruption_.postpone();
        write_mesh(path_ / name, mesh, meshed, settings_);
    } catch (const std::bad_alloc&) {
        row.error = "out of memory: request larger lengths";
    } catch (const std::exception& error) {
        row.error = error.what();
    }
    const auto whole = interruption_.postpone();
    rows_.push_back(row);
    record(false);
    for (const std::string& why : {row.error, row.shortfall}) {
        if (!why.empty()) spdlog::warn("{}: {}", mesh_label(row), why);
    }
    if (row.error.empty() && !quiet_) {
        print_error(fmt::format("mesh {}: {}, {}: {} tets, L_R {:.4f}, {:.1f} s\n", rows_.size(),
                                mesh_label(row), mesh_setting(row), row.conformity.tets,
                                row.conformity.l_r, row.cost.seconds));
    }
}

void MeshFolder::end() { record(true); }

void MeshFolder::remove_files_of_meshers() const {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(path_, ignored)) {
        if (entry.is_directory(ignored)) std::filesystem::remove_all(entry.path(), ignored);
    }
}

void MeshFolder::record(bool complete) const {
    replace_file(path_ / results_file, mesh_json(provenance_, study_, settings_, rows_, complete));
}

}  // namespace controlspace

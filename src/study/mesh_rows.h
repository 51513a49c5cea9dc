// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/measure/accuracy.h"
#include "controlspace/mesh/conformity.h"
#include "controlspace/mesh/mesh_run.h"
#include "controlspace/study/case.h"
#include "controlspace/study/provenance.h"
#include "controlspace/study/study.h"
#include "study/mesh_settings.h"

namespace controlspace {

/// The outcome of meshing one field; nothing is measured where there is an error.
struct MeshRow {
    Case setting = {};   ///< of the exact field: of the first structure that it is compared with
    bool exact = false;  ///< the reference itself was meshed, by no structure
    std::filesystem::path saved = {};  ///< the .ctrl that was meshed: the reference too
    Mesher mesher = Mesher::delaunay;
    std::string error = {};
    std::string shortfall = {};  ///< why a requested target was missed; empty where it was met
    Conformity conformity = {};  ///< to the reference
    double creation_s = 0;       ///< of the structure
    MeshCost cost = {};          ///< memory: of the program and, if that is more, of MMG
    std::optional<Accuracy> delta_r = {};  ///< δ_R of the structure; none: the reference was meshed
    std::optional<double> beside_exact = {};  ///< L_R less that of the mesh of the exact field
};

/// For the terminal: the measures for each setting. bench/tables adds the lengths of edges and the
/// rank correlation of L_R and δ_R.
std::string mesh_tables(std::span<const MeshRow> rows);

/// meshes.json: provenance, settings of the study (but its runs) and of the meshing, and rows.
std::string mesh_json(const Provenance& provenance, const Study& study,
                      const MeshSettings& settings, std::span<const MeshRow> rows, bool complete);

/// "K_L s_L", or "exact".
std::string mesh_label(const MeshRow& row);

/// The requested setting; of a saved control space, its file.
std::string mesh_setting(const MeshRow& row);

}  // namespace controlspace

#include <vector>

#include "baselines/peers/gmsh/gmsh_rows.h"

namespace controlspace {

std::vector<CatalogueEntry> gmsh_rows() { return {gmsh_view_row(), gmsh_structured_row()}; }

}  // namespace controlspace

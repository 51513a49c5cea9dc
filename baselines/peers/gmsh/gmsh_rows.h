#pragma once

#include "controlspace/space/catalogue.h"

namespace controlspace {

CatalogueEntry gmsh_view_row();
CatalogueEntry gmsh_structured_row();

}  // namespace controlspace

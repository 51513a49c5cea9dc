// SPDX-License-Identifier: Apache-2.0
#include "data_folder.h"

std::filesystem::path data_folder() { return CONTROLSPACE_DATA_DIR; }

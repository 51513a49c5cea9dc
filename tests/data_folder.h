// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

/// The project's folder `data`, absolute.
std::filesystem::path data_folder();

#pragma once

#include "study/file_readers.h"

namespace controlspace {

/// The readers of .vdb files; empty ones where the program is built without OpenVDB.
FileReaders vdb_readers();

}  // namespace controlspace

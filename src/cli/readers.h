#pragma once

#include "study/file_readers.h"

namespace controlspace {

/// Readers of all formats whose libraries the program is built with.
FileReaders file_readers();

}  // namespace controlspace

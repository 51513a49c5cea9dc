#pragma once

#include "controlspace/space/control_space.h"

namespace controlspace {

/// Answers places on standard input by lengths on standard output, as Gmsh's field ExternalProcess
/// asks: three doubles in, one out, in the machine's own bytes; each as soon as it can be read. A
/// NaN or the end of input ends it. Throws InputError where the input breaks off within a place, or
/// if reading or writing fails.
void answer_places(const ControlSpace& space);

}  // namespace controlspace

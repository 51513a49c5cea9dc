// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace controlspace {

/// From now on this process may read files and no more: what writes, renames or removes files,
/// opens sockets, starts programs or reaches into other processes fails with EACCES. There is no
/// way back. Does nothing where the kernel has no filters of system calls (seccomp), or the
/// processor is neither x86-64 nor AArch64.
void give_up_rights();

}  // namespace controlspace

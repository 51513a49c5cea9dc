// SPDX-License-Identifier: Apache-2.0
#include "io/give_up_rights.h"

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace controlspace {
namespace {

constexpr std::uint32_t processor =
#ifdef __x86_64__
    AUDIT_ARCH_X86_64;
#else
    AUDIT_ARCH_AARCH64;
#endif

constexpr std::uint32_t forbidden[] = {
#ifdef __x86_64__  // the older forms, which AArch64 never had
    SYS_creat, SYS_unlink, SYS_rename, SYS_link, SYS_symlink, SYS_mkdir, SYS_rmdir, SYS_mknod,
    SYS_chmod, SYS_chown, SYS_lchown, SYS_fork, SYS_vfork,
#endif
    // Files. openat2 hides its flags from a filter.
    SYS_openat2, SYS_unlinkat, SYS_renameat2, SYS_renameat, SYS_linkat, SYS_symlinkat, SYS_mkdirat,
    SYS_mknodat, SYS_fchmod, SYS_fchmodat, SYS_fchown, SYS_fchownat, SYS_truncate, SYS_ftruncate,
    SYS_setxattr, SYS_lsetxattr, SYS_fsetxattr, SYS_mount, SYS_umount2, SYS_io_uring_setup,
    // Networks, programs and other processes.
    SYS_socket, SYS_socketpair, SYS_execve, SYS_execveat, SYS_ptrace, SYS_process_vm_readv,
    SYS_process_vm_writev, SYS_kill, SYS_bpf};

using Filter = std::vector<sock_filter>;

constexpr std::uint32_t allow = SECCOMP_RET_ALLOW, refuse = SECCOMP_RET_ERRNO | EACCES;

void load(Filter& filter, std::size_t offset) {
    filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
}
void answer(Filter& filter, std::uint32_t what) {
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, what));
}
/// Skips the next `skipped` steps unless the loaded number is `number`.
void unless_equal(Filter& filter, std::uint32_t number, std::uint8_t skipped) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, 0, skipped));
}

/// Refuses the call `number` if its argument `flags` asks for more than reading.
void refuse_writing(Filter& filter, std::uint32_t number, std::size_t flags) {
    constexpr std::uint32_t writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
    constexpr std::size_t low_half = 0;  // both processors are little-endian
    unless_equal(filter, number, 4);
    load(filter, offsetof(seccomp_data, args) + flags * sizeof(std::uint64_t) + low_half);
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, writing, 0, 1));
    answer(filter, refuse);
    answer(filter, allow);
}

}  // namespace

void give_up_rights() {
    Filter filter;
    load(filter, offsetof(seccomp_data, arch));
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, processor, 1, 0));
    answer(filter, refuse);  // calls of another processor's kind, by other numbers
    load(filter, offsetof(seccomp_data, nr));
#ifdef __x86_64__
    constexpr std::uint32_t x32 = 0x40000000;  // numbers of a third kind
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, x32, 0, 1));
    answer(filter, refuse);
    refuse_writing(filter, SYS_open, 1);
#endif
    for (const std::uint32_t number : forbidden) {
        unless_equal(filter, number, 1);
        answer(filter, refuse);
    }
    refuse_writing(filter, SYS_openat, 2);
    answer(filter, allow);

    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
    ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

}  // namespace controlspace

#else

namespace controlspace {

void give_up_rights() {}

}  // namespace controlspace

#endif

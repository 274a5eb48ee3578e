// SPDX-License-Identifier: Apache-2.0
// Preloaded into Debian 12's linux.uml (6.1). It keeps a process's processor state in 2696 bytes: x87 to
// PKRU. Where the host's XSAVE area is larger (AMX), PTRACE_SETREGSET with so few is EINVAL or EFAULT and
// the guest dies at once. So: read the whole area, lay the guest's part over it, write the whole back.
#define _GNU_SOURCE
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

// <sys/ptrace.h> declares a ptrace with an enum for its first parameter: its numbers are given here.
enum { PEEKTEXT = 1, PEEKUSER = 3, GETREGSET = 0x4204, SETREGSET = 0x4205, NOTE_XSTATE = 0x202 };
enum { AREA_BYTES_MAX = 65536, HEADER_BYTE = 512, KNOWN_COMPONENTS = 0x3ff };

long ptrace(long request, ...);

long ptrace(long request, ...) {
  va_list rest;
  va_start(rest, request);
  const long pid = va_arg(rest, int);
  void *const address = va_arg(rest, void *);
  void *const data = va_arg(rest, void *);
  va_end(rest);

  // the C library's convention for the peeks: the word is the result
  if (request >= PEEKTEXT && request <= PEEKUSER) {
    long word = 0;
    const long result = syscall(SYS_ptrace, request, pid, address, &word);
    if (result < 0) return result;
    errno = 0;
    return word;
  }
  if (request == SETREGSET && (uintptr_t)address == NOTE_XSTATE) {
    static _Alignas(64) unsigned char area[AREA_BYTES_MAX];
    const struct iovec *const part = data;
    struct iovec whole = {.iov_base = area, .iov_len = sizeof area};
    if (syscall(SYS_ptrace, (long)GETREGSET, pid, address, &whole) < 0) return -1;
    if (part->iov_len < whole.iov_len) {
      memcpy(area, part->iov_base, part->iov_len);
      // the header's bits say which components are in use: those past the guest's part are not
      uint64_t in_use;
      memcpy(&in_use, area + HEADER_BYTE, sizeof in_use);
      in_use &= KNOWN_COMPONENTS;
      memcpy(area + HEADER_BYTE, &in_use, sizeof in_use);
      return syscall(SYS_ptrace, request, pid, address, &whole);
    }
  }
  return syscall(SYS_ptrace, request, pid, address, data);
}

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// OpenBLAS, which is loaded with OpenCV, asks for memory again and again where a limit leaves too
/// little, so that a program never begins. This library is initialized first (CMakeLists.txt) and
/// ends the program instead.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>

#include "core/program.h"

namespace cdiff::core {
namespace {

constexpr std::size_t kNeeded = std::size_t{256} << 20;  // [bytes]; OpenBLAS alone takes 128 MiB
constexpr char kText[] =
    "out of memory: the limits of this shell leave less than 256 MiB when the program is loaded; "
    "raise ulimit -v and ulimit -d\n";

/// Calls the system alone: not even the standard library is initialized.
[[gnu::constructor]] void requireMemory() {
  void* const place = ::mmap(nullptr, kNeeded, PROT_READ | PROT_WRITE,
                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (place != MAP_FAILED) {
    ::munmap(place, kNeeded);
    return;
  }
  static_cast<void>(::write(STDERR_FILENO, kText, sizeof(kText) - 1));
  ::_exit(ExitCode::kRunTimeError);
}

}  // namespace
}  // namespace cdiff::core

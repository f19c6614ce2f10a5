// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Processes as the kernel lists them.
#pragma once

#include <sys/types.h>

#include <fstream>
#include <string>

namespace cdiff::test {

/// One that is dead but not reaped yet counts as dead.
inline bool isAlive(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(stat, text);
  return !text.empty() && text.find(") Z ") == std::string::npos;
}

}  // namespace cdiff::test

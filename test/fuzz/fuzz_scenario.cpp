// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A scenario file is read, or refused with an InputError: of whatever bytes it is made.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "e2e_cdiff/core/exceptions.h"
#include "session/scenario_options.h"

using namespace cdiff;

namespace {

/// A file in memory, one a process.
std::filesystem::path scenarioFile() {
  return "/dev/shm/e2e_cdiff_fuzz_" + std::to_string(getpid()) + ".yaml";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file = scenarioFile();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    session::loadScenario(file.string());
  } catch (const core::InputError&) {
  }
  return 0;
}

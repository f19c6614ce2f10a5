// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where tests find real input: E2E_CDIFF_DATA, else ../shared/data beside the source tree. Tests
/// skip where it is missing.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace cdiff::test {

/// The path of a file of the real input, whether it exists or not.
inline std::filesystem::path realData(const std::string& relative) {
  const char* given = std::getenv("E2E_CDIFF_DATA");
  const std::filesystem::path source = std::filesystem::path(__FILE__).parent_path() / "../..";
  return (given ? std::filesystem::path(given) : source / "../shared/data") / relative;
}

}  // namespace cdiff::test

/// Ends the test as skipped, saying so, when the file is missing.
#define CDIFF_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "real input is missing: " << (path)

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where tests find real input: E2E_CDIFF_DATA, else ../shared/data beside the source tree, which
/// ctest names in E2E_CDIFF_SHARE. Tests skip where it is missing.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace cdiff::test {

/// The path of a file of the real input, whether it exists or not.
inline std::filesystem::path realData(const std::string& relative) {
  const char* given = std::getenv("E2E_CDIFF_DATA");
  if (given != nullptr) return std::filesystem::path(given) / relative;
  // __FILE__ is relative under ccache's base folder.
  const char* share = std::getenv("E2E_CDIFF_SHARE");
  const std::filesystem::path source =
      share ? std::filesystem::path(share)
            : std::filesystem::path(__FILE__).parent_path() / "../..";
  return source / "../shared/data" / relative;
}

}  // namespace cdiff::test

/// Ends the test as skipped, saying so, when the file is missing.
#define CDIFF_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "real input is missing: " << (path)

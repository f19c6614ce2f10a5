// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where the reference measures lie, for tests.
#pragma once

#include <cstdlib>
#include <filesystem>

#include "core/file.h"

namespace cdiff::test {

/// E2E_CDIFF_DATA, else ../shared/data beside the source folder.
inline std::filesystem::path referenceFile(const std::string& name) {
  const char* data = std::getenv("E2E_CDIFF_DATA");
  const std::filesystem::path folder = data != nullptr
                                           ? std::filesystem::path(data)
                                           : core::shareFolder() / ".." / "shared" / "data";
  return folder / "reference" / name;
}

}  // namespace cdiff::test

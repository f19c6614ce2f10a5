// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A cache folder of its own for a test, as long as the object exists.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "support/temporary_folder.h"

namespace cdiff::test {

class OwnCache {
 public:
  OwnCache() {
    if (const char* before = std::getenv(kVariable)) before_ = before;
    ::setenv(kVariable, path().c_str(), 1);
  }
  ~OwnCache() {
    if (before_) {
      ::setenv(kVariable, before_->c_str(), 1);
    } else {
      ::unsetenv(kVariable);
    }
  }
  OwnCache(const OwnCache&) = delete;
  OwnCache& operator=(const OwnCache&) = delete;
  /// The folder; nobody has made it yet.
  std::filesystem::path path() const { return folder_.path() / "cache"; }

 private:
  static constexpr const char* kVariable = "E2E_CDIFF_CACHE";
  TemporaryFolder folder_;
  std::optional<std::string> before_;
};

}  // namespace cdiff::test

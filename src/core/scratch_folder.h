// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

#include "core/file_descriptor.h"

namespace cdiff::core {

/// A temporary folder of this process below TMPDIR, removed with the object. The first one of a
/// process also removes those of processes that are gone.
class ScratchFolder {
 public:
  /// Throws InputError when none can be made.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  FileDescriptor descriptor_;  ///< of the folder; locked
};

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>

#include "core/output_folder.h"

namespace cdiff::record {

/// Throws InputError when another process writes into the folder, or when it holds anything of a
/// session or a batch, naming it, unless earlier sessions are to be overwritten; a batch never is.
/// A folder that is absent is free.
void requireFreeFolder(const std::filesystem::path& folder, bool overwrite);

/// The result folder of a session, claimed by the one process that writes it: locked against a
/// second one, and without what an earlier session left.
class ResultFolder {
 public:
  /// Makes and locks the folder, checks it as requireFreeFolder does, and removes the files of an
  /// earlier session and what writes that were cut off left. `program` names this writer to a
  /// second one ("cdiff run"). Throws InputError; nothing is removed then.
  ResultFolder(std::filesystem::path folder, const std::string& program, bool overwrite);
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  core::FolderLock lock_;
};

}  // namespace cdiff::record

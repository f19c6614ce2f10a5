// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/result_folder.h"

#include <array>
#include <utility>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

namespace fs = std::filesystem;

/// What makes a folder one with a result.
constexpr std::array<const char*, 9> kSessionFiles = {
    "session.yaml", "trace.csv",   "plans.csv",   "summary.json",      "junit.xml",
    "report.html",  "session.bag", "session.mp4", "session.bag.active"};
/// What the node graph leaves besides.
constexpr std::array<const char*, 2> kOtherFiles = {"exit_code", ".reserve"};
constexpr const char* kBatchFile = "matrix.yaml";

void clear(const fs::path& file) {
  std::error_code error;
  fs::remove_all(file, error);
  if (error) throw core::InputError("cannot replace '" + file.string() + "': " + error.message());
}

void removeSession(const fs::path& folder) {
  for (const char* name : kSessionFiles) clear(folder / name);
  for (const char* name : kOtherFiles) clear(folder / name);
  core::removeTemporaries(folder);
}

void requireNoResult(const fs::path& folder, bool overwrite) {
  std::error_code error;
  if (fs::exists(folder / kBatchFile, error)) {
    throw core::InputError("'" + folder.string() + "' holds the results of a batch (" + kBatchFile +
                           "); give another folder");
  }
  if (overwrite) return;
  for (const char* name : kSessionFiles) {
    if (!fs::exists(folder / name, error)) continue;
    throw core::InputError("'" + folder.string() + "' holds an earlier result (" + name +
                           "); give another folder, or overwrite it (--overwrite, in launch "
                           "files overwrite:=true)");
  }
}

}  // namespace

void requireFreeFolder(const fs::path& folder, bool overwrite) {
  core::FolderLock::requireUnlocked(folder);
  requireNoResult(folder, overwrite);
}

ResultFolder::ResultFolder(fs::path folder, const std::string& program, bool overwrite)
    : path_(std::move(folder)), lock_(path_, program) {
  requireNoResult(path_, overwrite);
  removeSession(path_);
}

}  // namespace cdiff::record

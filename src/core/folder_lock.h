// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/file_descriptor.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

/// An output folder that is locked as long as the object exists, by the file kFile in it, which
/// names host, process, program and time. The kernel ends the lock with its process, so one that
/// was killed locks nothing.
class FolderLock {
 public:
  /// Name of the file.
  static constexpr const char* kFile = ".lock";

  /// Throws the constructor's InputError where another process holds the folder now; makes nothing.
  static void requireUnlocked(const std::filesystem::path& folder);
  /// Whether the file is there and names another host. Throws nothing.
  static bool isOfAnotherHost(const std::filesystem::path& folder);
  /// Removes the file of a process that no kernel says to hold it. For callers who know that the
  /// process is gone, also where it was one of another host.
  static void removeLeftBehind(const std::filesystem::path& folder);

  /// Makes the folder and its parents. `program` names this writer to a second one ("cdiff run").
  /// Throws InputError naming host and process of the writer that holds it, why the folder or the
  /// file cannot be made, or that the folder is a link or the file no lock of this program.
  FolderLock(const std::filesystem::path& folder, const std::string& program);
  /// Removes the file, and the folders that it made where they are still empty.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  void takeLock();
  bool tryLock();
  bool placeSigned();
  bool takeOver();
  void removeMade() const;

  std::filesystem::path folder_;
  std::string program_;
  std::vector<std::filesystem::path> made_;  ///< innermost first
  FileDescriptor directory_;
  FileDescriptor descriptor_;  ///< of the lock file
};

}  // namespace cdiff::core

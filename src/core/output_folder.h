// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::core {

// Folders that one process at a time writes into, and temporary folders that a later run removes
// when ours is killed.

/// An output folder that is locked as long as the object exists, by the file kFile in it, which
/// names host, process, program and time. The kernel ends the lock with its process, so one that
/// was killed locks nothing.
class FolderLock {
 public:
  /// Name of the file.
  static constexpr const char* kFile = ".lock";

  /// Throws the constructor's InputError where another process holds the folder now; makes nothing.
  static void requireUnlocked(const std::filesystem::path& folder);

  /// Makes the folder and its parents. `program` names this writer to a second one ("cdiff run").
  /// Throws InputError naming host and process of the writer that holds it, or why the folder or
  /// the file cannot be made.
  FolderLock(const std::filesystem::path& folder, const std::string& program);
  /// Removes the file, and the folders that it made where they are still empty.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  void takeLock();
  bool tryLock();
  void removeMade() const;
  void requireOwnHost() const;
  void sign(const std::string& program);

  std::filesystem::path folder_;
  std::filesystem::path file_;
  std::vector<std::filesystem::path> made_;  ///< innermost first
  int descriptor_ = -1;
};

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
  int descriptor_ = -1;  ///< of the folder; locked
};

}  // namespace cdiff::core

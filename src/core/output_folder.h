// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/file_descriptor.h"
#include "core/folder_lock.h"

namespace cdiff::core {

// Folders that the program writes into. Nothing that it did not make itself is ever replaced or
// removed there: each folder keeps a record of the files that are the program's.

/// A folder that the program writes files into. Its record (the hidden file kRecord) lists by name
/// what the program made there; only that may be replaced or removed. Everything else that is found
/// is left alone, and refused where it has the name of a file that is to be written. Several
/// processes may write into one folder, each with an object of its own; at most one of them holds
/// its lock. Names are those of entries of the folder itself, without slashes.
class OutputFolder {
 public:
  /// Name of the record.
  static constexpr const char* kRecord = ".cdiff_files";

  /// Throws InputError when `folder` holds an entry of one of these names that its record does not
  /// list. A folder that is absent is free.
  static void requireFree(const std::filesystem::path& folder,
                          const std::vector<std::string>& names);
  /// Whether its record lists the name; makes nothing.
  static bool lists(const std::filesystem::path& folder, const std::string& name);

  /// Makes the folder and its parents where they are missing. Throws InputError when it cannot be
  /// made, is a file, or is a symbolic link.
  explicit OutputFolder(const std::filesystem::path& folder);
  /// The same, and locks it for `program` ("cdiff run") as long as the object exists.
  OutputFolder(const std::filesystem::path& folder, const std::string& program);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where the folder lies now: a folder that was renamed meanwhile is followed; one that was
  /// deleted is made again at its old place, and wasDeleted() is true from then on.
  std::filesystem::path path() const;
  bool wasDeleted() const { return deleted_; }

  /// Enters a file's name into the record, before the file is made, and returns its path. Throws
  /// InputError when an entry of that name is there that the record does not list, or that is no
  /// regular file.
  std::filesystem::path claim(const std::string& name);
  /// Writes a whole file: it is whole or as it was before. Throws InputError naming the path.
  void write(const std::string& name, std::string_view content);
  /// What the record lists.
  std::set<std::string> names() const;
  /// Removes the files of these names that the record lists, and folders of it that are empty then,
  /// and takes them off the record. Throws InputError naming what cannot be removed.
  void remove(const std::set<std::string>& names);
  /// The same for everything on the record.
  void clear();
  /// Takes away what writes that were cut off left.
  void removeUnfinished();
  /// Ends the record: from now on the files are the user's.
  void forget();
  /// Throws Error when the folder was renamed or deleted since the object was made.
  void requireInPlace() const;
  /// Makes a folder in it and returns its path. Throws InputError when something else has that
  /// name.
  std::filesystem::path subfolder(const std::string& name);
  /// The same for many, whose names enter the record at once.
  void makeSubfolders(const std::vector<std::string>& names);

 private:
  friend class PendingFile;
  void makeAgain() const;
  bool removeEntry(const std::filesystem::path& folder, const std::string& name);

  std::unique_ptr<FolderLock> lock_;
  std::filesystem::path path_;
  mutable FileDescriptor descriptor_;  ///< stays with the folder when it is renamed
  mutable bool deleted_ = false;
};

/// A file of an output folder that gets its name when it is whole. Until then it is NAME.part.
class PendingFile {
 public:
  /// Claims the name and takes `room` bytes on the disk, so that as much can be written when the
  /// disk has filled up since. `folder` must outlive the object. Throws InputError naming the path.
  PendingFile(OutputFolder& folder, const std::string& name, std::size_t room = 0);
  /// Removes what was written, unless `finish` was called.
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Throws InputError naming the path.
  void append(std::string_view text);
  /// Flushes it to the disk and gives it its name; also where the folder was deleted meanwhile.
  /// Call once. Throws InputError naming the path; nothing of the file stays then, unless a file of
  /// the user's has taken the name meanwhile: NAME.part stays beside it.
  void finish();

 private:
  void open();
  bool place();
  void claimOrKeep();
  void restore();
  void discard();
  [[noreturn]] void fail(int reason);

  OutputFolder& folder_;
  std::string name_;
  std::string part_;
  off_t written_ = 0;
  bool kept_ = false;  ///< the part stays
  FileDescriptor descriptor_;
};

/// OutputFolder::write for a file given by its path.
void writeOwnFile(const std::filesystem::path& path, std::string_view content);

}  // namespace cdiff::core

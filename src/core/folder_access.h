// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "core/file_descriptor.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

// What locks, leases and records do with folders: no link is followed, and nothing is replaced.

/// A file cannot be opened because too many are open. To those who go on without the file it is as
/// any that cannot be opened; to the user it is a run-time error.
class TooManyOpenFiles : public InputError {
 public:
  using InputError::InputError;
};

/// Throws InputError over a file; TooManyOpenFiles where that is why. `error` is of errno.
[[noreturn]] void failOverFile(const std::string& text, int error);

/// The same: "cannot WHAT 'path': REASON".
[[noreturn]] void failOn(const std::filesystem::path& path, const std::string& what, int error);

/// Whether two files are one.
bool isSame(const struct stat& left, const struct stat& right);

/// Whether `name` in a folder is the file that is open, and no link to it.
bool isSameFile(int descriptor, int directory, const char* name);

/// Gives a file another name unless something has it. Answers 0 or why not.
int placeUnlessThere(const std::filesystem::path& from, const std::filesystem::path& to);

/// A file that gets its name when it is whole.
struct Draft {
  std::filesystem::path path;
  FileDescriptor descriptor;
};

/// Makes one with this text in a folder, and locks it, so that its writer is known to live. Where
/// that fails its descriptor is closed, errno says why, and nothing stays.
Draft makeDraft(const std::filesystem::path& folder, std::string_view text);

/// Removes the drafts of a folder whose writers are gone.
void removeLeftDrafts(const std::filesystem::path& folder);

/// The path without a slash at its end, which would follow a link.
std::filesystem::path withoutSlash(const std::filesystem::path& folder);

/// Opens a folder that is no link; none where nothing is there. Throws InputError naming what is
/// there instead.
FileDescriptor openFolderIfThere(const std::filesystem::path& folder);
/// As above, and throws InputError where nothing is there.
FileDescriptor openFolder(const std::filesystem::path& folder);

/// Makes a folder and its parents where they are missing, and opens it.
FileDescriptor makeFolder(const std::filesystem::path& folder);

}  // namespace cdiff::core

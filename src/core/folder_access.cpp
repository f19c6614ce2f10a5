// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/folder_access.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

namespace fs = std::filesystem;

namespace {
constexpr const char* kDraftStem = ".cdiff_draft.";
}  // namespace

void failOverFile(const std::string& text, int error) {
  if (error == EMFILE || error == ENFILE) throw TooManyOpenFiles(text);
  throw InputError(text);
}

void failOn(const fs::path& path, const std::string& what, int error) {
  failOverFile("cannot " + what + " '" + path.string() + "': " + writeErrorText(error), error);
}

bool isSame(const struct stat& left, const struct stat& right) {
  return left.st_dev == right.st_dev && left.st_ino == right.st_ino;
}

bool isSameFile(int descriptor, int directory, const char* name) {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor, &held) == 0 &&
         ::fstatat(directory, name, &named, AT_SYMLINK_NOFOLLOW) == 0 && isSame(held, named);
}

int placeUnlessThere(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  return ::link(from.c_str(), to.c_str()) == 0 ? 0 : errno;  // a file system that cannot do that
}

Draft makeDraft(const fs::path& folder, std::string_view text) {
  std::string name = (folder / kDraftStem).string() + "XXXXXX";
  FileDescriptor descriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (!descriptor) return {};
  errno = ENOSPC;  // where less than all is written
  // Until it is locked another process may take it for left behind: its writer finds it gone then.
  const bool written =
      ::flock(descriptor.get(), LOCK_EX | LOCK_NB) == 0 && ::fchmod(descriptor.get(), 0644) == 0 &&
      ::pwrite(descriptor.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (written) return {name, std::move(descriptor)};
  const int reason = errno;
  descriptor.close();
  ::unlink(name.c_str());
  errno = reason;
  return {};
}

void removeLeftDrafts(const fs::path& folder) {
  constexpr int kFlags = O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().filename().string().rfind(kDraftStem, 0) != 0) continue;
    if (entry.is_symlink(none) || !entry.is_regular_file(none)) continue;
    const FileDescriptor draft(::open(entry.path().c_str(), kFlags));
    if (draft && ::flock(draft.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(entry.path().c_str());
  }
}

fs::path withoutSlash(const fs::path& folder) {
  return folder.has_filename() ? folder : folder.parent_path();
}

FileDescriptor openFolderIfThere(const fs::path& folder) {
  constexpr int kFlags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
  FileDescriptor descriptor(::open(folder.c_str(), kFlags));
  if (descriptor || errno == ENOENT) return descriptor;
  int reason = errno;
  std::error_code none;
  const bool below_a_file = reason == ENOTDIR && !fs::exists(fs::symlink_status(folder, none));
  if (below_a_file) return descriptor;
  if (fs::is_symlink(folder, none) && ::access(folder.c_str(), F_OK) != 0) reason = errno;
  if (fs::is_symlink(folder, none) && fs::is_directory(folder, none)) {
    throw InputError("'" + folder.string() + "' is a symbolic link to '" +
                     fs::read_symlink(folder, none).string() + "'; give the folder itself");
  }
  if (fs::exists(folder, none) && !fs::is_directory(folder, none))
    throw InputError("'" + folder.string() + "' is a file; give a folder");
  failOn(folder, "open the folder", reason);
}

FileDescriptor openFolder(const fs::path& folder) {
  FileDescriptor descriptor = openFolderIfThere(folder);
  if (!descriptor) failOn(folder, "open the folder", ENOENT);
  return descriptor;
}

FileDescriptor makeFolder(const fs::path& folder) {
  constexpr int kTries = 10;  // another process may remove it as soon as it is made
  for (int i = 0; i < kTries; ++i) {
    std::error_code error;
    if (!fs::is_symlink(folder, error)) fs::create_directories(folder, error);
    if (error == std::errc::no_such_file_or_directory && i + 1 < kTries) continue;
    if (error && (!fs::exists(folder) || fs::is_directory(folder)))
      throw InputError("cannot make the folder '" + folder.string() + "': " + error.message());
    if (FileDescriptor descriptor = openFolderIfThere(folder)) return descriptor;
  }
  return openFolder(folder);
}

}  // namespace cdiff::core

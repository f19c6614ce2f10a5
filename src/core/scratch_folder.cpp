// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <mutex>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/folder_access.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;
constexpr const char* kScratchPrefix = "e2e_cdiff_scratch_";
/// In a scratch folder, which so is known to be the program's.
constexpr const char* kScratchMark = ".cdiff_scratch";
/// A scratch folder is unlocked for a moment after it is made.
constexpr std::chrono::minutes kOldEnough{1};

/// Folders whose process is gone hold no lock.
void removeOrphans(const fs::path& parent) {
  std::error_code error;
  std::vector<fs::path> orphans;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename().string().rfind(kScratchPrefix, 0) != 0) continue;
    struct stat status {};
    if (::lstat(entry->path().c_str(), &status) != 0 || status.st_uid != ::geteuid()) continue;
    const auto age = std::time(nullptr) - status.st_mtime;
    if (age >= std::chrono::seconds(kOldEnough).count()) orphans.push_back(entry->path());
  }
  for (const fs::path& orphan : orphans) {
    constexpr int kFlags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    const FileDescriptor folder(::open(orphan.c_str(), kFlags));
    if (!folder) continue;
    std::error_code ignored;
    struct stat mark {};
    const bool ours = ::fstatat(folder.get(), kScratchMark, &mark, AT_SYMLINK_NOFOLLOW) == 0;
    if (ours && ::flock(folder.get(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(orphan, ignored);
  }
}

}  // namespace

ScratchFolder::ScratchFolder() {
  const fs::path parent = temporaryFolder();
  static std::once_flag once;
  std::call_once(once, removeOrphans, parent);
  std::string name = (parent / kScratchPrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) failOn(parent, "make a temporary folder in", errno);
  path_ = name;
  descriptor_ = FileDescriptor(::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor_) return;
  ::flock(descriptor_.get(), LOCK_EX | LOCK_NB);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;
  const FileDescriptor mark(::openat(descriptor_.get(), kScratchMark, kFlags, 0644));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace cdiff::core

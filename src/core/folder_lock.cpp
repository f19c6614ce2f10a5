// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "core/folder_access.h"
#include "core/holder.h"
#include "core/host.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;
/// For a writer that was killed a moment ago to be gone.
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kPeriod{20};

InputError heldBy(const fs::path& folder, int descriptor) {
  return InputError("'" + folder.string() + "' is being written by " +
                    holderText(holderFacts(descriptor)) +
                    "; wait until it has ended, or give another folder");
}

bool isLock(int descriptor) {
  struct stat status {};
  const auto content = holderFacts(descriptor);
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && content.size() == 4 &&
         content.count("host") + content.count("process") + content.count("program") +
                 content.count("since") ==
             4;
}

/// The folder and its parents that do not exist, the innermost first.
std::vector<fs::path> missingFolders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code error;
  fs::path place = fs::absolute(folder, error).lexically_normal();
  if (!place.has_filename()) place = place.parent_path();
  for (; !fs::exists(place, error) && place != place.parent_path(); place = place.parent_path())
    missing.push_back(place);
  return missing;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder, const std::string& program)
    : folder_(withoutSlash(folder)), program_(program), made_(missingFolders(folder_)) {
  try {
    takeLock();
  } catch (...) {
    removeMade();
    throw;
  }
}

void FolderLock::requireUnlocked(const fs::path& folder) {
  constexpr int kFlags = O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const FileDescriptor file(::open((folder / kFile).c_str(), kFlags));
  if (!file || !isLock(file.get())) return;
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw heldBy(folder, file.get());
}

bool FolderLock::isOfAnotherHost(const fs::path& folder) {
  constexpr int kFlags = O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const FileDescriptor file(::open((folder / kFile).c_str(), kFlags));
  return file && isLock(file.get()) && holderFacts(file.get())["host"] != hostName();
}

void FolderLock::removeLeftBehind(const fs::path& folder) {
  constexpr int kFlags = O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;  // NFS locks no others
  const fs::path path = folder / kFile;
  const FileDescriptor file(::open(path.c_str(), kFlags));
  if (file && isLock(file.get()) && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0)
    ::unlink(path.c_str());
}

FolderLock::~FolderLock() {
  if (isSameFile(descriptor_.get(), directory_.get(), kFile))
    ::unlinkat(directory_.get(), kFile, 0);
  descriptor_.close();  // a file system may keep the name of an open file
  removeMade();
}

void FolderLock::removeMade() const {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());  // refused where it holds anything
}

void FolderLock::takeLock() {
  const std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  while (!tryLock()) {
    if (std::chrono::steady_clock::now() - begin > kPatience)
      throw heldBy(folder_, descriptor_.get());
    std::this_thread::sleep_for(kPeriod);
  }
}

/// Whether the lock is ours. It is not where another process has it or removes it just now.
bool FolderLock::tryLock() {
  descriptor_.close();
  directory_ = makeFolder(folder_);
  return placeSigned() || takeOver();
}

/// Places a lock that is locked and signed before anybody can see it, where there is none.
bool FolderLock::placeSigned() {
  const fs::path file = folder_ / kFile;
  Draft draft = makeDraft(folder_, holderSignature(program_));
  if (!draft.descriptor) failOn(file, "write", errno);
  const int reason = placeUnlessThere(draft.path, file);
  const bool placed = isSameFile(draft.descriptor.get(), directory_.get(), kFile);
  if (placed) descriptor_ = std::move(draft.descriptor);
  ::unlink(draft.path.c_str());
  // Taken, or the draft or the folder was removed just now.
  const bool again = reason == EEXIST || reason == ENOENT;
  if (!placed && !again) failOn(file, "write", reason);
  return placed;
}

/// Takes the lock of a process of this host that is gone.
bool FolderLock::takeOver() {
  constexpr int kFlags = O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  const fs::path file = folder_ / kFile;
  descriptor_ = FileDescriptor(::openat(directory_.get(), kFile, kFlags));
  if (!descriptor_ && errno == ENOENT) return false;
  if (!descriptor_ && errno != ELOOP && errno != ENXIO && errno != EISDIR)
    failOn(file, "write", errno);
  if (!descriptor_ || !isLock(descriptor_.get())) {
    throw InputError("'" + file.string() +
                     "' is no lock of this program; move it away, or give another folder");
  }
  if (::flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK || errno == EINTR) return false;
    failOn(file, "lock", errno);
  }
  if (!isSameFile(descriptor_.get(), directory_.get(), kFile)) return false;
  // The kernel of another host may not have announced its lock to ours.
  if (holderFacts(descriptor_.get())["host"] != hostName()) {
    throw InputError("'" + folder_.string() + "' is being written by " +
                     holderText(holderFacts(descriptor_.get())) +
                     "; if that process is gone, delete '" + file.string() + "'");
  }
  const std::string text = holderSignature(program_);
  if (::ftruncate(descriptor_.get(), 0) != 0 ||
      ::pwrite(descriptor_.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    failOn(file, "write", errno);
  return true;
}

}  // namespace cdiff::core

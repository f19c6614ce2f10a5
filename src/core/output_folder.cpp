// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "core/file.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;
/// For a writer that was killed a moment ago to be gone.
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kPeriod{20};
constexpr const char* kScratchPrefix = "e2e_cdiff_scratch_";
/// A scratch folder is unlocked for a moment after it is made.
constexpr std::chrono::minutes kOldEnough{1};

std::string hostName() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Lines "key: value" of a lock file.
std::map<std::string, std::string> contentOf(int descriptor) {
  std::array<char, 1024> buffer{};
  const ssize_t count = ::pread(descriptor, buffer.data(), buffer.size(), 0);
  std::map<std::string, std::string> content;
  for (const std::string& line :
       splitText({buffer.data(), static_cast<std::size_t>(count > 0 ? count : 0)}, '\n')) {
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) content[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return content;
}

bool isSameFile(int descriptor, const fs::path& file) {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

std::string holderText(int descriptor) {
  auto content = contentOf(descriptor);
  return "'" + content["program"] + "', process " + content["process"] + " on host " +
         content["host"] + ", since " + content["since"];
}

InputError heldBy(const fs::path& folder, int descriptor) {
  return InputError("'" + folder.string() + "' is being written by " + holderText(descriptor) +
                    "; wait until it has ended, or give another folder");
}

[[noreturn]] void failOn(const fs::path& path, const std::string& what, int error) {
  throw InputError("cannot " + what + " '" + path.string() + "': " + writeErrorText(error));
}

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
    const int descriptor = ::open(orphan.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0) continue;
    std::error_code ignored;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove_all(orphan, ignored);
    ::close(descriptor);
  }
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
    : folder_(folder), file_(folder / kFile), made_(missingFolders(folder)) {
  try {
    takeLock();
  } catch (...) {
    removeMade();
    throw;
  }
  try {
    requireOwnHost();
    sign(program);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

void FolderLock::requireUnlocked(const fs::path& folder) {
  const int descriptor = ::open((folder / kFile).c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return;
  const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  const InputError error = heldBy(folder, descriptor);
  ::close(descriptor);
  if (held) throw error;
}

FolderLock::~FolderLock() {
  ::unlink(file_.c_str());
  ::close(descriptor_);
  removeMade();
}

void FolderLock::removeMade() const {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());  // refused where it holds anything
}

void FolderLock::takeLock() {
  const std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  while (!tryLock()) {
    if (std::chrono::steady_clock::now() - begin > kPatience) {
      const InputError error = heldBy(folder_, descriptor_);
      ::close(descriptor_);
      throw error;
    }
    ::close(descriptor_);
    std::this_thread::sleep_for(kPeriod);
  }
}

/// Makes the folder, opens the file and locks it, unless another process has it locked or removes
/// it just now.
bool FolderLock::tryLock() {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (fs::is_regular_file(folder_))
    throw InputError("'" + folder_.string() + "' is a file; give a folder");
  if (error)
    throw InputError("cannot make the folder '" + folder_.string() + "': " + error.message());
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) failOn(file_, "write", errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return isSameFile(descriptor_, file_);
  if (errno == EWOULDBLOCK || errno == EINTR) return false;
  const int reason = errno;
  ::close(descriptor_);
  failOn(file_, "lock", reason);
}

/// The kernel of another host may not have announced its lock to ours.
void FolderLock::requireOwnHost() const {
  const auto content = contentOf(descriptor_);
  const auto host = content.find("host");
  if (host == content.end() || host->second == hostName()) return;
  throw InputError("'" + folder_.string() + "' is being written by " + holderText(descriptor_) +
                   "; if that process is gone, delete '" + file_.string() + "'");
}

void FolderLock::sign(const std::string& program) {
  const std::string text = "host: " + hostName() + "\nprocess: " + std::to_string(::getpid()) +
                           "\nprogram: " + program + "\nsince: " + timeText() + "\n";
  const bool written =
      ::ftruncate(descriptor_, 0) == 0 &&
      ::pwrite(descriptor_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written) failOn(file_, "write", errno);
}

ScratchFolder::ScratchFolder() {
  const fs::path parent = temporaryFolder();
  static std::once_flag once;
  std::call_once(once, removeOrphans, parent);
  std::string name = (parent / kScratchPrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) failOn(parent, "make a temporary folder in", errno);
  path_ = name;
  descriptor_ = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ >= 0) ::flock(descriptor_, LOCK_EX | LOCK_NB);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/folder_access.h"
#include "core/program.h"
#include "core/text.h"

namespace cdiff::core {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRecordHead =
    "# What e2e_cdiff made in this folder and may replace. Delete this file to keep all of it.";
constexpr off_t kLargestRecord = off_t{1} << 26;  // [bytes]
constexpr const char* kPart = ".part";

/// The record of a folder, open and locked against other processes.
class Record {
 public:
  /// Opens the record, and makes it where there is none and it `must` be there.
  Record(int directory, const fs::path& folder, bool must)
      : directory_(directory), folder_(folder) {
    do {
      close();
      descriptor_ = open();
      if (descriptor_ < 0 && errno == ENOENT) {
        if (!must) return;
        make();
        continue;
      }
      if (descriptor_ < 0 && errno != ELOOP && errno != EISDIR && errno != ENXIO)
        failOn(folder / OutputFolder::kRecord, "write", errno);
      if (descriptor_ < 0 || !readNames()) {
        close();
        throw InputError("'" + (folder / OutputFolder::kRecord).string() +
                         "' is no record of this program; move it away, or give another folder");
      }
    } while (!isSameFile(descriptor_, directory, OutputFolder::kRecord));  // removed meanwhile
  }
  ~Record() { close(); }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  const std::set<std::string>& names() const { return names_; }
  bool lists(const std::string& name) const { return names_.count(name) != 0; }

  void add(const std::string& name) {
    if (names_.insert(name).second) store();
  }
  /// A record without names is removed.
  void erase(const std::string& name) {
    if (names_.erase(name) == 0) return;
    if (names_.empty()) {
      remove();
    } else {
      store();
    }
  }
  void remove() const {
    if (descriptor_ >= 0) ::unlinkat(directory_, OutputFolder::kRecord, 0);
  }

 private:
  void close() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  }

  int open() const {
    constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    const int descriptor = ::openat(directory_, OutputFolder::kRecord, O_RDWR | kFlags);
    if (descriptor >= 0 || (errno != EACCES && errno != EROFS)) return descriptor;
    return ::openat(directory_, OutputFolder::kRecord, O_RDONLY | kFlags);
  }

  /// Makes an empty one that is whole before anybody can see it.
  void make() const {
    const std::string text = std::string(kRecordHead) + "\n";
    const fs::path file = folder_ / OutputFolder::kRecord;
    std::string draft = file.string() + ".XXXXXX";
    const int descriptor = ::mkostemp(draft.data(), O_CLOEXEC);
    if (descriptor < 0) failOn(file, "write", errno);
    errno = ENOSPC;  // where less than all is written
    const bool written =
        ::pwrite(descriptor, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()) &&
        ::fchmod(descriptor, 0644) == 0;
    const int reason = written ? placeUnlessThere(draft, file) : errno;
    ::close(descriptor);
    ::unlink(draft.c_str());
    if (reason != 0 && reason != EEXIST) failOn(file, "write", reason);
  }

  /// Whether it is a record.
  bool readNames() {
    struct stat status {};
    while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) continue;
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode) ||
        status.st_size > kLargestRecord)
      return false;
    text_.assign(static_cast<std::size_t>(status.st_size), '\0');
    const ssize_t count = ::pread(descriptor_, text_.data(), text_.size(), 0);
    text_.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    names_.clear();
    if (text_.rfind(kRecordHead, 0) != 0) return false;
    std::vector<std::string> lines = splitText(text_, '\n');
    if (text_.back() != '\n') lines.pop_back();  // cut off
    for (const std::string& line : lines) {
      const bool name = !line.empty() && line.find('/') == std::string::npos && line != "." &&
                        line != ".." && line != kRecordHead;
      if (name) names_.insert(line);
    }
    return true;
  }

  /// Writes it in place, in the order of the names; on a full disk it is as it was before.
  void store() {
    std::string text = std::string(kRecordHead) + "\n";
    for (const std::string& name : names_) text += name + "\n";
    const auto write = [this](const std::string& content) {
      return ::pwrite(descriptor_, content.data(), content.size(), 0) ==
                 static_cast<ssize_t>(content.size()) &&
             ::ftruncate(descriptor_, static_cast<off_t>(content.size())) == 0;
    };
    errno = ENOSPC;  // where less than all is written
    if (write(text)) {
      text_ = text;
      return;
    }
    const int reason = errno;
    (void)write(text_);
    failOn(folder_ / OutputFolder::kRecord, "write", reason);
  }

  int directory_;
  fs::path folder_;
  int descriptor_ = -1;
  std::string text_;
  std::set<std::string> names_;
};

bool isThere(int directory, const std::string& name, struct stat& status) {
  return ::fstatat(directory, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
}

/// Throws InputError where something is there under this name that is not the program's.
void requireOwn(int directory, const fs::path& folder, const std::string& name,
                const Record& record) {
  struct stat status {};
  if (!isThere(directory, name, status)) return;
  const std::string place = "'" + (folder / name).string() + "'";
  if (!record.lists(name)) {
    throw InputError(place +
                     " would be replaced, but this program has no record of having made it (" +
                     OutputFolder::kRecord + "); move it away, or give another folder");
  }
  if (!S_ISREG(status.st_mode)) {
    throw InputError(place + " is no regular file any more; move it away, or give another folder");
  }
}

}  // namespace

void OutputFolder::requireFree(const fs::path& folder, const std::vector<std::string>& names) {
  std::error_code none;
  if (!fs::is_directory(folder, none) && !fs::exists(fs::symlink_status(folder, none))) return;
  const int directory = openFolder(withoutSlash(folder));
  try {
    const Record record(directory, folder, false);
    for (const std::string& name : names) {
      requireOwn(directory, folder, name, record);
      requireOwn(directory, folder, name + kPart, record);
    }
  } catch (...) {
    ::close(directory);
    throw;
  }
  ::close(directory);
}

bool OutputFolder::lists(const fs::path& folder, const std::string& name) {
  const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return false;
  const bool listed = Record(directory, folder, false).lists(name);
  ::close(directory);
  return listed;
}

OutputFolder::OutputFolder(const fs::path& folder)
    : path_(withoutSlash(fs::absolute(folder).lexically_normal())),
      descriptor_(makeFolder(path_)) {}

OutputFolder::OutputFolder(const fs::path& folder, const std::string& program)
    : lock_(std::make_unique<FolderLock>(folder, program)),
      path_(withoutSlash(fs::absolute(folder).lexically_normal())),
      descriptor_(openFolder(path_)) {}

OutputFolder::~OutputFolder() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

fs::path OutputFolder::path() const {
  struct stat held {};
  struct stat named {};
  if (::fstat(descriptor_, &held) != 0) failOn(path_, "find", errno);
  if (::stat(path_.c_str(), &named) == 0 && isSame(held, named)) return path_;
  std::error_code error;
  const fs::path now = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor_), error);
  if (!error && ::stat(now.c_str(), &named) == 0 && isSame(held, named)) return now;
  makeAgain();
  return path_;
}

void OutputFolder::makeAgain() const {
  const int descriptor = makeFolder(path_);
  ::close(std::exchange(descriptor_, descriptor));
  deleted_ = true;
}

fs::path OutputFolder::claim(const std::string& name) {
  const fs::path folder = path();
  Record record(descriptor_, folder, true);
  requireOwn(descriptor_, folder, name, record);
  record.add(name);
  return folder / name;
}

void OutputFolder::write(const std::string& name, std::string_view content) {
  PendingFile file(*this, name);
  file.append(content);
  file.finish();
}

void OutputFolder::remove(const std::string& name) {
  const fs::path folder = path();
  Record record(descriptor_, folder, false);
  if (!record.lists(name)) return;
  struct stat status {};
  const bool there = isThere(descriptor_, name, status);
  if (there && S_ISREG(status.st_mode) && ::unlinkat(descriptor_, name.c_str(), 0) != 0)
    failOn(folder / name, "replace", errno);
  if (there && S_ISDIR(status.st_mode)) {
    OutputFolder(folder / name).clear();
    // Refused where a file of the user's is in it: then it stays, and stays on the record.
    if (::unlinkat(descriptor_, name.c_str(), AT_REMOVEDIR) != 0) return;
  }
  record.erase(name);
}

std::set<std::string> OutputFolder::names() const {
  const fs::path folder = path();
  return Record(descriptor_, folder, false).names();
}

void OutputFolder::clear() {
  for (const std::string& name : names()) remove(name);
}

void OutputFolder::removeUnfinished() {
  for (const std::string& name : names())
    if (endsWith(name, kPart)) remove(name);
}

void OutputFolder::forget() {
  const fs::path folder = path();
  Record(descriptor_, folder, false).remove();
}

fs::path OutputFolder::subfolder(const std::string& name) {
  const fs::path folder = path();
  struct stat status {};
  if (!isThere(descriptor_, name, status)) claim(name);
  ::close(makeFolder(folder / name));
  return folder / name;
}

PendingFile::PendingFile(OutputFolder& folder, const std::string& name, std::size_t room)
    : folder_(folder), name_(name), part_(name + kPart) {
  OutputFolder::requireFree(folder_.path(), {name_});
  open();
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const auto size = static_cast<off_t>(std::min<rlim_t>(room, limit.rlim_cur));
  const bool taken = size == 0 || ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, size) == 0 ||
                     errno == EOPNOTSUPP || errno == ENOSYS;
  if (!taken) fail(errno);
}

PendingFile::~PendingFile() {
  try {
    discard();
  } catch (const std::exception&) {
    // What cannot be removed stays on the record.
  }
}

/// Opens a new file of the temporary name.
void PendingFile::open() {
  folder_.remove(part_);  // of a write that was cut off
  folder_.claim(part_);
  constexpr int kFlags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  descriptor_ = ::openat(folder_.descriptor_, part_.c_str(), kFlags, 0644);
  if (descriptor_ < 0) fail(errno);
}

void PendingFile::append(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    written_ += written;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void PendingFile::finish() {
  // The room that was not needed is given back.
  if (::ftruncate(descriptor_, written_) != 0) fail(errno);
  folder_.path();  // looks where the folder is
  if (!isSameFile(descriptor_, folder_.descriptor_, part_.c_str())) restore();
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  folder_.claim(name_);
  const int directory = folder_.descriptor_;
  if (::renameat(directory, part_.c_str(), directory, name_.c_str()) != 0) fail(errno);
  folder_.remove(part_);
}

/// Writes what was written so far into a new file: the old one was deleted with its folder.
void PendingFile::restore() {
  const int deleted = std::exchange(descriptor_, -1);
  std::string content(static_cast<std::size_t>(std::exchange(written_, 0)), '\0');
  const ssize_t count = ::pread(deleted, content.data(), content.size(), 0);
  ::close(deleted);
  if (count != static_cast<ssize_t>(content.size())) fail(EIO);
  open();
  append(content);
}

void PendingFile::discard() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  folder_.remove(part_);
}

void PendingFile::fail(int reason) {
  const fs::path path = folder_.path() / name_;
  discard();
  throw InputError("cannot write '" + path.string() + "': " + writeErrorText(reason) +
                   "; check that the folder exists, is writable and has room");
}

void writeOwnFile(const fs::path& path, std::string_view content) {
  OutputFolder(path.parent_path()).write(path.filename().string(), content);
}

}  // namespace cdiff::core

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
#include <chrono>
#include <thread>
#include <utility>

#include "core/folder_access.h"
#include "core/program.h"
#include "core/text.h"

namespace cdiff::core {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRecordHead =
    "# What e2e_cdiff made in this folder and may replace. Delete this file to keep all of it.";
constexpr off_t kLargestRecord = off_t{1} << 23;  // [bytes]
/// For another process to write the record.
constexpr std::chrono::seconds kRecordPatience{5};
constexpr const char* kPart = ".part";
/// How often something is tried whose folder was renamed or deleted at that moment.
constexpr int kTries = 5;

/// What was being written is not there any more: its folder was renamed or deleted.
class Vanished : public InputError {
 public:
  using InputError::InputError;
};

/// Throws Vanished or another InputError.
[[noreturn]] void failOnRecord(const fs::path& folder, int reason) {
  const fs::path file = folder / OutputFolder::kRecord;
  if (reason != ENOENT) failOn(file, "write", reason);
  throw Vanished("cannot write '" + file.string() + "': " + writeErrorText(reason));
}

/// Does it again, a few times, where the folder vanished meanwhile: each action looks anew where
/// the folder is.
template <typename Action>
auto again(const Action& action) {
  for (int left = kTries; left > 1; --left) {
    try {
      return action();
    } catch (const Vanished&) {
      continue;
    }
  }
  return action();
}

/// The record of a folder, open and locked against other processes until it is changed, once.
class Record {
 public:
  /// Opens the record, and makes it where there is none and it `must` be there.
  Record(int directory, const fs::path& folder, bool must)
      : directory_(directory), folder_(folder) {
    do {
      descriptor_ = open();
      if (!descriptor_ && errno == ENOENT) {
        if (!must) return;
        make();
        continue;
      }
      if (!descriptor_ && errno != ELOOP && errno != EISDIR && errno != ENXIO)
        failOnRecord(folder, errno);
      if (!descriptor_ || !readNames()) {
        throw InputError("'" + (folder / OutputFolder::kRecord).string() +
                         "' is no record of this program; move it away, or give another folder");
      }
    } while (
        !isSameFile(descriptor_.get(), directory, OutputFolder::kRecord));  // removed meanwhile
  }

  const std::set<std::string>& names() const { return names_; }
  bool lists(const std::string& name) const { return names_.count(name) != 0; }

  void add(const std::set<std::string>& names) {
    const std::size_t before = names_.size();
    names_.insert(names.begin(), names.end());
    if (names_.size() != before) store();
  }
  /// A record without names is removed.
  void erase(const std::set<std::string>& names) {
    const std::size_t before = names_.size();
    for (const std::string& name : names) names_.erase(name);
    if (names_.size() == before) return;
    if (names_.empty()) {
      remove();
    } else {
      store();
    }
  }
  void remove() const {
    if (descriptor_) ::unlinkat(directory_, OutputFolder::kRecord, 0);
  }

 private:
  FileDescriptor open() const {
    constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    FileDescriptor descriptor(::openat(directory_, OutputFolder::kRecord, O_RDWR | kFlags));
    if (descriptor || (errno != EACCES && errno != EROFS)) return descriptor;
    return FileDescriptor(::openat(directory_, OutputFolder::kRecord, O_RDONLY | kFlags));
  }

  /// A new file beside the record that holds these names.
  Draft draftOf(const std::set<std::string>& names) const {
    std::string text = std::string(kRecordHead) + "\n";
    for (const std::string& name : names) text += name + "\n";
    Draft draft = makeDraft(folder_, text);
    if (!draft.descriptor) failOnRecord(folder_, errno);
    return draft;
  }

  /// Makes an empty one that is whole before anybody can see it.
  void make() const {
    const Draft draft = draftOf({});
    const int reason = placeUnlessThere(draft.path, folder_ / OutputFolder::kRecord);
    ::unlink(draft.path.c_str());
    if (reason != 0 && reason != EEXIST) failOnRecord(folder_, reason);
  }

  /// Whether it is a record.
  bool readNames() {
    struct stat status {};
    if (::fstat(descriptor_.get(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
    lock();
    if (::fstat(descriptor_.get(), &status) != 0 || status.st_size > kLargestRecord) return false;
    std::string text(static_cast<std::size_t>(status.st_size), '\0');
    const ssize_t count = ::pread(descriptor_.get(), text.data(), text.size(), 0);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    names_.clear();
    if (text.rfind(kRecordHead, 0) != 0) return false;
    std::vector<std::string> lines = splitText(text, '\n');
    if (text.back() != '\n') lines.pop_back();  // cut off
    for (const std::string& line : lines) {
      const bool name = !line.empty() && line.find('/') == std::string::npos && line != "." &&
                        line != ".." && line != kRecordHead;
      if (name) names_.insert(line);
    }
    return true;
  }

  void lock() const {
    const auto begin = std::chrono::steady_clock::now();
    while (::flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0) {
      if (std::chrono::steady_clock::now() - begin > kRecordPatience)
        throw InputError("another process holds '" + (folder_ / OutputFolder::kRecord).string() +
                         "' for longer than 5 s; end it, or give another folder");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  /// Replaces the record by a new file: a backup may hold the old one under another name.
  void store() const {
    const fs::path file = folder_ / OutputFolder::kRecord;
    const Draft draft = draftOf(names_);
    if (::rename(draft.path.c_str(), file.c_str()) == 0) return;
    const int reason = errno;
    ::unlink(draft.path.c_str());
    failOnRecord(folder_, reason);
  }

  int directory_;
  fs::path folder_;
  FileDescriptor descriptor_;
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
  const FileDescriptor directory = openFolderIfThere(withoutSlash(folder));
  if (!directory) return;
  const Record record(directory.get(), folder, false);
  for (const std::string& name : names) {
    requireOwn(directory.get(), folder, name, record);
    requireOwn(directory.get(), folder, name + kPart, record);
  }
}

bool OutputFolder::lists(const fs::path& folder, const std::string& name) {
  const FileDescriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return directory && Record(directory.get(), folder, false).lists(name);
}

OutputFolder::OutputFolder(const fs::path& folder)
    : path_(withoutSlash(fs::absolute(folder).lexically_normal())),
      descriptor_(makeFolder(path_)) {}

OutputFolder::OutputFolder(const fs::path& folder, const std::string& program)
    : lock_(std::make_unique<FolderLock>(folder, program)),
      path_(withoutSlash(fs::absolute(folder).lexically_normal())),
      descriptor_(openFolder(path_)) {}

fs::path OutputFolder::path() const {
  struct stat held {};
  struct stat named {};
  if (::fstat(descriptor_.get(), &held) != 0) failOn(path_, "find", errno);
  if (::stat(path_.c_str(), &named) == 0 && isSame(held, named)) return path_;
  std::error_code error;
  const fs::path now =
      fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor_.get()), error);
  if (!error && ::stat(now.c_str(), &named) == 0 && isSame(held, named)) return now;
  // Another host may have moved a folder of a shared disk: then it only looks deleted from here.
  const bool looks_deleted = !error && endsWith(now.string(), " (deleted)");
  if (looks_deleted && ::fstat(descriptor_.get(), &held) == 0 && held.st_nlink > 0)
    throw Error("another folder has taken the place of '" + path_.string() +
                "'; nothing more is written into it");
  makeAgain();
  return path_;
}

void OutputFolder::makeAgain() const {
  descriptor_ = makeFolder(path_);
  deleted_ = true;
}

fs::path OutputFolder::claim(const std::string& name) {
  const auto is_control = [](unsigned char sign) { return sign < 0x20 || sign == 0x7f; };
  if (name.empty() || name.find('/') != std::string::npos ||
      std::any_of(name.begin(), name.end(), is_control)) {
    throw InputError("'" + (path() / name).string() +
                     "' is no name for a file: it holds a slash or a control character");
  }
  return again([&] {
    const fs::path folder = path();
    Record record(descriptor_.get(), folder, true);
    requireOwn(descriptor_.get(), folder, name, record);
    record.add({name});
    return folder / name;
  });
}

void OutputFolder::write(const std::string& name, std::string_view content) {
  PendingFile file(*this, name);
  file.append(content);
  file.finish();
}

void OutputFolder::remove(const std::set<std::string>& names) {
  again([&] {
    const fs::path folder = path();
    Record record(descriptor_.get(), folder, false);
    std::set<std::string> gone;
    for (const std::string& name : names) {
      if (record.lists(name) && removeEntry(folder, name)) gone.insert(name);
    }
    record.erase(gone);
  });
}

/// Whether nothing of the program's is left under this name, which the record lists.
bool OutputFolder::removeEntry(const fs::path& folder, const std::string& name) {
  struct stat status {};
  if (!isThere(descriptor_.get(), name, status)) return true;
  if (S_ISREG(status.st_mode) && ::unlinkat(descriptor_.get(), name.c_str(), 0) != 0 &&
      errno != ENOENT)
    failOn(folder / name, "replace", errno);
  if (!S_ISDIR(status.st_mode)) return true;
  OutputFolder(folder / name).clear();
  // Refused where a file of the user's is in it: then it stays, and stays on the record.
  return ::unlinkat(descriptor_.get(), name.c_str(), AT_REMOVEDIR) == 0;
}

std::set<std::string> OutputFolder::names() const {
  const fs::path folder = path();
  return Record(descriptor_.get(), folder, false).names();
}

void OutputFolder::clear() { remove(names()); }

void OutputFolder::removeUnfinished() {
  std::set<std::string> unfinished;
  for (const std::string& name : names()) {
    if (endsWith(name, kPart)) unfinished.insert(name);
  }
  remove(unfinished);
  removeLeftDrafts(path());
}

void OutputFolder::requireInPlace() const {
  const fs::path now = path();
  if (deleted_)
    throw Error("the folder '" + path_.string() +
                "' was deleted meanwhile; what was written before is lost");
  if (now != path_)
    throw Error("the folder '" + path_.string() + "' was renamed to '" + now.string() +
                "' meanwhile; what was written after that is in a folder of the old name");
}

void OutputFolder::forget() {
  const fs::path folder = path();
  Record(descriptor_.get(), folder, false).remove();
}

fs::path OutputFolder::subfolder(const std::string& name) {
  const fs::path folder = path();
  struct stat status {};
  if (!isThere(descriptor_.get(), name, status)) claim(name);
  makeFolder(folder / name);
  return folder / name;
}

void OutputFolder::makeSubfolders(const std::vector<std::string>& names) {
  std::set<std::string> missing;
  for (const std::string& name : names) {
    struct stat status {};
    if (!isThere(descriptor_.get(), name, status)) missing.insert(name);
  }
  again([&] { Record(descriptor_.get(), path(), true).add(missing); });
  for (const std::string& name : names) makeFolder(path() / name);
}

PendingFile::PendingFile(OutputFolder& folder, const std::string& name, std::size_t room)
    : folder_(folder), name_(name), part_(name + kPart) {
  OutputFolder::requireFree(folder_.path(), {name_});
  open();
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const auto size = static_cast<off_t>(std::min<rlim_t>(room, limit.rlim_cur));
  const bool taken = size == 0 ||
                     ::fallocate(descriptor_.get(), FALLOC_FL_KEEP_SIZE, 0, size) == 0 ||
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
  folder_.remove({part_});  // of a write that was cut off
  for (int left = kTries; left > 0 && !descriptor_; --left) {
    folder_.claim(part_);
    constexpr int kFlags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    descriptor_ = FileDescriptor(::openat(folder_.descriptor_.get(), part_.c_str(), kFlags, 0644));
    if (!descriptor_ && errno != ENOENT) fail(errno);
  }
  if (!descriptor_) fail(ENOENT);
}

void PendingFile::append(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    written_ += written;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void PendingFile::finish() {
  // The room that was not needed is given back.
  if (::ftruncate(descriptor_.get(), written_) != 0) fail(errno);
  int left = kTries;
  while (!place()) {
    if (--left == 0) fail(ENOENT);
  }
  descriptor_.close();
  folder_.remove({part_});
}

/// Gives the file its name. Whether it was there to be named: its folder may have vanished.
bool PendingFile::place() {
  folder_.path();  // looks where the folder is
  if (!isSameFile(descriptor_.get(), folder_.descriptor_.get(), part_.c_str())) restore();
  if (::fsync(descriptor_.get()) != 0 && errno != EINVAL) fail(errno);
  // A file system that writes late says at a close what it could not write.
  FileDescriptor copy(::dup(descriptor_.get()));
  if (!copy || copy.close() != 0) fail(errno);
  claimOrKeep();
  const int directory = folder_.descriptor_.get();
  if (::renameat(directory, part_.c_str(), directory, name_.c_str()) == 0) return true;
  if (errno != ENOENT) fail(errno);
  return false;
}

/// Where a file of the user's has the name by now, what was written stays as NAME.part.
void PendingFile::claimOrKeep() {
  try {
    folder_.claim(name_);
  } catch (const TooManyOpenFiles&) {
    throw;
  } catch (const InputError& error) {
    kept_ = true;
    throw InputError(std::string(error.what()) + "; what was to be written is in '" +
                     (folder_.path() / part_).string() + "'");
  }
}

/// Writes what was written so far into a new file: the old one was deleted with its folder.
void PendingFile::restore() {
  const FileDescriptor deleted = std::move(descriptor_);
  std::string content(static_cast<std::size_t>(std::exchange(written_, 0)), '\0');
  const ssize_t count = ::pread(deleted.get(), content.data(), content.size(), 0);
  if (count != static_cast<ssize_t>(content.size())) fail(EIO);
  open();
  append(content);
}

void PendingFile::discard() {
  // First without a file that is opened for it, since there may be too many.
  const int directory = folder_.descriptor_.get();
  if (!kept_ && isSameFile(descriptor_.get(), directory, part_.c_str()))
    ::unlinkat(directory, part_.c_str(), 0);
  descriptor_.close();
  if (!kept_) folder_.remove({part_});
}

void PendingFile::fail(int reason) {
  const fs::path path = folder_.path() / name_;
  discard();
  failOverFile("cannot write '" + path.string() + "': " + writeErrorText(reason) +
                   "; check that the folder exists, is writable and has room",
               reason);
}

void writeOwnFile(const fs::path& path, std::string_view content) {
  OutputFolder(path.parent_path()).write(path.filename().string(), content);
}

}  // namespace cdiff::core

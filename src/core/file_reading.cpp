// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Reading of whole files (core/file.h).
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

/// `name` is what the file is and its path, for errors.
void requireRegular(mode_t mode, const std::string& name) {
  if (S_ISREG(mode)) return;
  const char* kind = S_ISDIR(mode)                    ? "folder"
                     : S_ISFIFO(mode)                 ? "pipe"
                     : S_ISSOCK(mode)                 ? "socket"
                     : S_ISCHR(mode) || S_ISBLK(mode) ? "device"
                                                      : "special file";
  throw InputError(name + " is a " + kind + "; a file was expected");
}

[[noreturn]] void failReading(const std::string& name) {
  throw InputError("cannot read " + name + ": " + std::strerror(errno));
}

[[noreturn]] void refuseSize(const std::string& name, std::uintmax_t size, std::uintmax_t most) {
  throw InputError(name + " has " + std::to_string(size) + " bytes; at most " +
                   std::to_string(most) + " were expected");
}

/// A descriptor that is closed with its object.
class OpenedFile {
 public:
  /// Opens a regular file. Does not wait for the other end of a pipe that took its place meanwhile.
  OpenedFile(const fs::path& path, const std::string& name)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
    if (descriptor_ < 0) failReading(name);
  }
  ~OpenedFile() { ::close(descriptor_); }
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Bytes of an opened file that has about `expected` of them; a file that grows beyond `most` while
/// it is read is refused.
std::string contentWithin(int descriptor, std::uintmax_t expected, std::uintmax_t most,
                          const std::string& name) {
  std::string content(expected + 1, '\0');  // the one more shows the end
  std::size_t filled = 0;
  while (true) {
    const ssize_t count = ::read(descriptor, &content[filled], content.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failReading(name);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
    if (filled > most) refuseSize(name, filled, most);
    if (filled == content.size())
      content.resize(std::min<std::uintmax_t>(2 * filled + 4096, most + 1));
  }
  content.resize(filled);
  return content;
}

}  // namespace

void requireRegularFile(const fs::path& path, const std::string& what) {
  const std::string name = what + " '" + path.string() + "'";
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) failReading(name);
  requireRegular(status.st_mode, name);
}

std::string readFile(const fs::path& path, const std::string& what, std::uintmax_t most) {
  requireRegularFile(path, what);  // to open a device may already have an effect
  const std::string name = what + " '" + path.string() + "'";
  const OpenedFile file(path, name);
  struct stat status {};
  if (::fstat(file.descriptor(), &status) != 0) failReading(name);
  requireRegular(status.st_mode, name);
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  if (size > most) refuseSize(name, size, most);
  return contentWithin(file.descriptor(), size, most, name);
}

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/file.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/file_descriptor.h"
#include "core/folder_access.h"
#include "core/program.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

EVP_MD_CTX* digestContext(void* context) { return static_cast<EVP_MD_CTX*>(context); }

fs::path libraryFolder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&sha256), &info) == 0 || info.dli_fname == nullptr)
    return {};
  return fs::absolute(info.dli_fname).parent_path();
}

[[noreturn]] void failWriting(const fs::path& path, int reason) {
  failOverFile("cannot write '" + path.string() + "': " + writeErrorText(reason) +
                   "; check that the folder exists, is writable and has room",
               reason);
}

/// Whether all of it was written and reached the disk; errno says why not.
bool writeAll(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL;
}

/// Whether an existing path names an open stream: /dev/stdout, /dev/fd/3.
bool isOpenStream(const fs::path& path) {
  const fs::path folder = fs::canonical(fs::absolute(path).parent_path());
  if (folder.filename() == "fd" && folder.string().rfind("/proc/", 0) == 0) return true;
  return fs::is_symlink(path) && isOpenStream(folder / fs::read_symlink(path));
}

/// Where an output of this name goes: through a link only to what lies beside it, or is no file.
fs::path outputPlace(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::canonical(path, error);
  if (!error && !fs::is_regular_file(target)) return path;
  if (!error && target.parent_path() == fs::canonical(fs::absolute(path).parent_path()))
    return target;
  throw InputError(
      "'" + path.string() + "' is a symbolic link to '" + fs::read_symlink(path, error).string() +
      "', which is no file of the same folder; give a file itself, or remove the link");
}

/// Opens a device or pipe for writing.
int openThrough(const fs::path& path, const struct stat& status) {
  if (S_ISBLK(status.st_mode))
    throw InputError("'" + path.string() + "' is a disk; a file was expected");
  constexpr int kFlags = O_WRONLY | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  const int descriptor = ::open(path.c_str(), kFlags);
  if (descriptor < 0 && errno == ENXIO)
    throw InputError("'" + path.string() + "' is a pipe that nobody reads; a file was expected");
  if (descriptor < 0) failWriting(path, errno);
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  return descriptor;
}

/// Makes a new file beside `path` and puts its name into `temporary`.
int openBeside(const fs::path& path, fs::path& temporary) {
  for (int i = 0;; ++i) {
    temporary = path.string() + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(i);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    const int descriptor = ::open(temporary.c_str(), kFlags, 0644);
    if (descriptor >= 0) return descriptor;
    if (errno != EEXIST) failWriting(path, errno);
  }
}

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
  const int reason = errno;
  failOverFile("cannot read " + name + ": " + writeErrorText(reason), reason);
}

[[noreturn]] void refuseSize(const std::string& name, std::uintmax_t size, std::uintmax_t most) {
  throw InputError(name + " has " + std::to_string(size) + " bytes; at most " +
                   std::to_string(most) + " were expected");
}

/// Opens a regular file. Does not wait for the other end of a pipe that took its place meanwhile.
FileDescriptor opened(const fs::path& path, const std::string& name) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!file) failReading(name);
  return file;
}

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

fs::file_type statusOf(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type != fs::file_type::none) return type;
  throw InputError("cannot use '" + shortened(path.string()) + "': " + error.message() +
                   "; a path that exists and can be read was expected");
}

fs::path firstEnvironmentFolder() {
  if (const char* folder = std::getenv("E2E_CDIFF_CACHE")) return folder;
  if (const char* folder = std::getenv("XDG_CACHE_HOME")) return fs::path(folder) / "e2e_cdiff";
  if (const char* folder = std::getenv("HOME")) return fs::path(folder) / ".cache" / "e2e_cdiff";
  return temporaryFolder() / ("e2e_cdiff_" + std::to_string(::getuid()));
}

}  // namespace

bool isFile(const fs::path& path) { return statusOf(path) == fs::file_type::regular; }

bool isFolder(const fs::path& path) { return statusOf(path) == fs::file_type::directory; }

fs::path temporaryFolder() {
  std::error_code error;
  fs::path folder = fs::temp_directory_path(error);
  std::string reason = "which is no folder that can be written to; set it to one, or unset it";
  if (!error && ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) {
    const std::string path = folder.string();
    if (path.find(',') == std::string::npos && path.find("${") == std::string::npos) return folder;
    reason = "where SUMO takes ',' and '${' for more than a name; set it to another folder";
  }
  for (const char* name : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {
    const char* given = std::getenv(name);
    if (given == nullptr) continue;
    throw InputError(std::string("environment variable ") + name + " is '" + given + "', " +
                     reason);
  }
  throw InputError("no temporary folder can be written to; set TMPDIR to one");
}

void requireRegularFile(const fs::path& path, const std::string& what) {
  const std::string name = what + " '" + path.string() + "'";
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) failReading(name);
  requireRegular(status.st_mode, name);
}

std::string readFile(const fs::path& path, const std::string& what, std::uintmax_t most) {
  requireRegularFile(path, what);  // to open a device may already have an effect
  const std::string name = what + " '" + path.string() + "'";
  const FileDescriptor file = opened(path, name);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) failReading(name);
  requireRegular(status.st_mode, name);
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  if (size > most) refuseSize(name, size, most);
  return contentWithin(file.get(), size, most, name);
}

void writeFileAtomically(const fs::path& path, std::string_view content) {
  struct stat status {};
  const bool stream = ::stat(path.c_str(), &status) == 0 && isOpenStream(path);
  const fs::path place = stream ? path : outputPlace(path);
  const bool there = ::stat(place.c_str(), &status) == 0;
  if (there && S_ISDIR(status.st_mode))
    throw InputError("'" + path.string() + "' is a folder; a file was expected");
  fs::path temporary;
  const bool through = stream || (there && !S_ISREG(status.st_mode));
  const int descriptor = through ? openThrough(place, status) : openBeside(place, temporary);
  if (there && !through) ::fchmod(descriptor, status.st_mode & 07777);
  int reason = writeAll(descriptor, content) ? 0 : errno;
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  if (reason == 0 && !through && ::rename(temporary.c_str(), place.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  if (!through) ::unlink(temporary.c_str());
  failWriting(path, reason);
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  EVP_DigestInit_ex(digestContext(context_), EVP_sha256(), nullptr);
}

Sha256::~Sha256() { EVP_MD_CTX_free(digestContext(context_)); }

void Sha256::update(std::string_view text) {
  EVP_DigestUpdate(digestContext(context_), text.data(), text.size());
}

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(digestContext(context_), digest.data(), &size);
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

std::string sha256(std::string_view content) {
  Sha256 hash;
  hash.update(content);
  return hash.finish();
}

fs::path shareFolder() {
  std::vector<fs::path> candidates;
  if (const char* folder = std::getenv("E2E_CDIFF_SHARE")) {
    if (!isFolder(fs::path(folder) / "config")) {
      throw InputError("environment variable E2E_CDIFF_SHARE is '" + std::string(folder) +
                       "', which holds no folder config; set it to the package's share folder, or "
                       "unset it");
    }
    candidates.emplace_back(folder);
  }
  candidates.push_back(libraryFolder().parent_path() / "share" / "e2e_cdiff");
  candidates.emplace_back(E2E_CDIFF_SOURCE_FOLDER);
  for (const fs::path& candidate : candidates) {
    if (isFolder(candidate / "config")) return fs::weakly_canonical(candidate);
  }
  throw InputError(
      "the package's config folder was not found; set E2E_CDIFF_SHARE to the folder that holds it");
}

std::vector<std::string> shippedNames(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path shippedOrFile(const fs::path& folder, const std::string& name_or_file,
                       const std::string& what) {
  if (isFile(name_or_file)) return fs::absolute(name_or_file);
  const fs::path shipped = folder / (name_or_file + ".yaml");
  if (isFile(shipped)) return shipped;
  if (fs::path(name_or_file).has_parent_path() || fs::path(name_or_file).extension() == ".yaml")
    throw InputError(what + " '" + name_or_file + "': there is no such file");
  if (isFile(name_or_file + ".yaml"))
    throw InputError(what + " '" + name_or_file + "': there is no such file; did you mean '" +
                     name_or_file + ".yaml'?");
  const std::vector<std::string> known = shippedNames(folder);
  throw InputError(what + " '" + name_or_file + "' is neither a file nor a shipped " + what +
                   "; the nearest shipped one is '" + nearestName(name_or_file, known) +
                   "' (all: " + joinText(known, ", ") + ")");
}

fs::path sumoHome() {
  const char* given = std::getenv("SUMO_HOME");
  std::error_code error;
  if (given != nullptr && fs::is_directory(given, error)) return given;
  return shareFolder() / "sumo";
}

fs::path cacheFolder() {
  const fs::path folder = firstEnvironmentFolder();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw InputError("cannot make the cache folder '" + folder.string() + "': " + error.message() +
                     "; set E2E_CDIFF_CACHE to a writable folder");
  }
  return folder;
}

}  // namespace cdiff::core

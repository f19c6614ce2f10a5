// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/file.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <openssl/evp.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "core/program.h"
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
  throw InputError("cannot write '" + path.string() + "': " + writeErrorText(reason) +
                   "; check that the folder exists, is writable and has room");
}

fs::path temporaryFor(const fs::path& path) {
  return path.string() + ".tmp." + std::to_string(::getpid());
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

constexpr const char* kTemporaryMark = ".tmp.";

template <class Wanted>
void removeTemporariesIf(const fs::path& folder, const Wanted& wanted) {
  std::error_code ignored;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(kTemporaryMark);
    if (mark != std::string::npos && wanted(name.substr(mark + std::strlen(kTemporaryMark))))
      files.push_back(entry.path());
  }
  for (const fs::path& file : files) fs::remove(file, ignored);
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
  if (!error && ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return folder;
  for (const char* name : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {
    const char* given = std::getenv(name);
    if (given == nullptr) continue;
    throw InputError(std::string("environment variable ") + name + " is '" + given +
                     "', which is no folder that can be written to; set it to one, or unset it");
  }
  throw InputError("no temporary folder can be written to; set TMPDIR to one");
}

void writeFileAtomically(const fs::path& path, std::string_view content) {
  const fs::path temporary = temporaryFor(path);
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) failWriting(path, errno);
  const bool written = writeAll(descriptor, content);
  int reason = written ? 0 : errno;
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  if (reason == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  ::unlink(temporary.c_str());
  failWriting(path, reason);
}

ReservedFile::ReservedFile(fs::path path, std::size_t size)
    : path_(std::move(path)), temporary_(temporaryFor(path_)) {
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const auto room = static_cast<off_t>(std::min<rlim_t>(size, limit.rlim_cur));
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor_ < 0) failWriting(path_, errno);
  const bool taken = room == 0 || ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, room) == 0 ||
                     errno == EOPNOTSUPP || errno == ENOSYS;
  if (taken) return;
  const int reason = errno;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
  failWriting(path_, reason);
}

ReservedFile::~ReservedFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void ReservedFile::write(std::string_view content) {
  const bool written = writeAll(descriptor_, content);
  int reason = written ? 0 : errno;
  // The room that was not needed is given back.
  if (written && ::ftruncate(descriptor_, static_cast<off_t>(content.size())) != 0) reason = errno;
  if (::close(std::exchange(descriptor_, -1)) != 0 && written) reason = errno;
  if (reason == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  ::unlink(temporary_.c_str());
  failWriting(path_, reason);
}

void removeTemporaries(const fs::path& folder) {
  removeTemporariesIf(folder, [](const std::string&) { return true; });
}

void removeDeadTemporaries(const fs::path& folder) {
  removeTemporariesIf(folder, [](const std::string& process) {
    const bool number = !process.empty() && process.size() < 10 &&
                        process.find_first_not_of("0123456789") == std::string::npos;
    return number && ::kill(std::stoi(process), 0) != 0 && errno == ESRCH;
  });
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

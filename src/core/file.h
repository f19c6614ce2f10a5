// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace cdiff::core {

// Files: whole-file reads with clear errors, atomic writes, SHA-256, and where the package's own
// files lie.

/// Whether a regular file, or a folder, is there. Throws InputError naming the path where the
/// system cannot tell: a loop of symbolic links, a folder that cannot be searched, a name too long.
bool isFile(const std::filesystem::path& path);
bool isFolder(const std::filesystem::path& path);

/// Largest file that is read, and largest file of options (scenario, evaluation, preset) [bytes].
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{2} << 30;
inline constexpr std::uintmax_t kLargestOptionsFile = std::uintmax_t{64} << 20;

/// The whole file. Throws InputError naming `what` and the path when it cannot be read, is no
/// regular file (nor a link to one), or is larger than `most` bytes or becomes so meanwhile. Pipes
/// and devices are refused without waiting.
std::string readFile(const std::filesystem::path& path, const std::string& what,
                     std::uintmax_t most = kLargestFile);

/// For files that another library or program opens: throws as readFile does, without reading.
void requireRegularFile(const std::filesystem::path& path, const std::string& what);

/// Writes a file that the user named as an output. A regular file is replaced: it is whole or as it
/// was before. A device or pipe is written through. Throws InputError naming the path; also for a
/// link to a file of another folder, a folder, a disk, and a pipe that nobody reads.
void writeFileAtomically(const std::filesystem::path& path, std::string_view content);

/// Length of a SHA-256 in hexadecimal digits.
inline constexpr std::size_t kSha256Digits = 64;

/// SHA-256 of `content` as lower-case hexadecimal digits.
std::string sha256(std::string_view content);

/// Incremental SHA-256 of a stream of texts.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void update(std::string_view text);
  /// Lower-case hexadecimal digits; the object is spent afterward.
  std::string finish();

 private:
  void* context_;
};

/// Folder that holds the package's config/, networks/ and launch/: E2E_CDIFF_SHARE, else the
/// installed share folder beside this library, else the source tree. Throws InputError when none
/// holds config/.
std::filesystem::path shareFolder();

/// Names of the YAML files in a folder, without their ending, sorted.
std::vector<std::string> shippedNames(const std::filesystem::path& folder);

/// `name_or_file` itself, made absolute, where it is a file, else `folder`/NAME.yaml. `folder` is
/// one below shareFolder(); `what` is what it holds ("scenario"). Throws InputError naming the
/// nearest shipped name.
std::filesystem::path shippedOrFile(const std::filesystem::path& folder,
                                    const std::string& name_or_file, const std::string& what);

/// What SUMO's programs need as SUMO_HOME: the environment's folder where there is one, else the
/// package's own, which holds type maps.
std::filesystem::path sumoHome();

/// TMPDIR (or TMP, TEMP, TEMPDIR), else /tmp. Throws InputError naming the variable when it is no
/// folder.
std::filesystem::path temporaryFolder();

/// Cache folder: E2E_CDIFF_CACHE, else XDG_CACHE_HOME/e2e_cdiff, else HOME/.cache/e2e_cdiff, else
/// the system's temporary folder; made when missing.
std::filesystem::path cacheFolder();

}  // namespace cdiff::core

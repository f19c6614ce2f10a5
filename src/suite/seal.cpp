// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/seal.h"

#include <map>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;
using core::InputError;

constexpr const char* kReason =
    "; a sealed suite must not change: restore the folder from the repository";

/// SHA-256 (hexadecimal) of each file, by its path relative to the suite's folder. Throws
/// InputError naming a line of another form.
std::map<std::string, std::string> readSeal(const fs::path& file) {
  std::map<std::string, std::string> hashes;
  for (const std::string& line : core::splitText(core::readFile(file, "seal"), '\n')) {
    const std::size_t gap = line.find("  ");
    if (gap != core::kSha256Digits || gap + 2 >= line.size())
      throw InputError("seal '" + file.string() + "': line '" + line +
                       "' is not \"SHA-256  PATH\"" + kReason);
    hashes[line.substr(gap + 2)] = line.substr(0, gap);
  }
  return hashes;
}

void requireHash(const fs::path& file, const std::string& expected) {
  const std::string found =
      core::isFile(file) ? core::sha256(core::readFile(file, "file of a sealed suite")) : "no file";
  if (found == expected) return;
  throw InputError("sealed suite: '" + file.string() +
                   "' differs from its seal (expected SHA-256 " + expected + ", found " + found +
                   ")" + kReason);
}

}  // namespace

bool hasSeal(const fs::path& suite_folder) { return core::isFile(suite_folder / kSealFile); }

void requireIntactSeal(const fs::path& suite_folder) {
  const auto hashes = readSeal(suite_folder / kSealFile);
  for (const auto& [path, hash] : hashes) requireHash(suite_folder / path, hash);
  for (const auto& entry : fs::recursive_directory_iterator(suite_folder)) {
    const std::string path = fs::relative(entry.path(), suite_folder).generic_string();
    if (!entry.is_regular_file() || path == kSealFile || hashes.count(path) != 0) continue;
    throw InputError("sealed suite: '" + entry.path().string() + "' is not in " +
                     (suite_folder / kSealFile).string() + kReason);
  }
}

std::optional<fs::path> sealedSuiteOf(const std::string& scenario) {
  if (!core::isFile(scenario)) return std::nullopt;
  const fs::path folder = fs::weakly_canonical(scenario).parent_path().parent_path();
  if (!hasSeal(folder)) return std::nullopt;
  return folder;
}

void requireOpen(const std::string& scenario) {
  const std::optional<fs::path> folder = sealedSuiteOf(scenario);
  if (!folder) return;
  throw InputError("'" + scenario + "' is a route of the sealed suite " +
                   folder->filename().string() +
                   ": nothing may be chosen on it, and every opening is recorded; run it by "
                   "cdiff evaluate with --open-sealed \"REASON\"");
}

void requireNotSealed(const std::string& scenario) {
  const std::optional<fs::path> folder = sealedSuiteOf(scenario);
  if (!folder) return;
  throw InputError("scenario '" + scenario + "' belongs to the sealed suite '" +
                   folder->filename().string() +
                   "', from which no training data may come; take a suite of your own ('cdiff "
                   "suite train --results DIR')");
}

}  // namespace cdiff::suite

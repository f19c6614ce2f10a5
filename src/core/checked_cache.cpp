// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/checked_cache.h"

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

fs::path checksumFile(const fs::path& file) { return file.string() + ".sha256"; }

}  // namespace

fs::path cacheFile(const std::string& folder, std::string_view key, const std::string& ending) {
  const fs::path place = cacheFolder() / folder;
  std::error_code error;
  fs::create_directories(place, error);
  if (error) {
    throw InputError("cannot make the cache folder '" + place.string() + "': " + error.message());
  }
  return place / (sha256(key) + ending);
}

std::optional<std::string> cachedContent(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  try {
    return readFile(file, "cached file");
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void storeInCache(const fs::path& file, std::string_view content) {
  std::error_code error;
  if (fs::symlink_status(file, error).type() != fs::file_type::regular) fs::remove(file, error);
  writeFileAtomically(file, content);
}

std::optional<std::string> checkedContent(const fs::path& file) {
  std::optional<std::string> content = cachedContent(file);
  const std::optional<std::string> checksum = cachedContent(checksumFile(file));
  if (content && checksum && *checksum == sha256(*content) + "\n") return content;
  return std::nullopt;
}

void storeChecked(const fs::path& file, std::string_view content) {
  storeInCache(file, content);
  storeInCache(checksumFile(file), sha256(content) + "\n");
}

}  // namespace cdiff::core

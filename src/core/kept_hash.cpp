// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/kept_hash.h"

#include <sys/stat.h>

#include <ctime>
#include <memory>

#include "core/file.h"
#include "core/kept_content.h"

namespace cdiff::core {
namespace {

constexpr std::time_t kSettled = 2;  // [s] a later change shows in the file's times

std::string textOf(const timespec& time) {
  return std::to_string(time.tv_sec) + "." + std::to_string(time.tv_nsec);
}

}  // namespace

std::string keptSha256(const std::filesystem::path& file, const std::string& what) {
  const auto hash = [&] { return std::make_shared<std::string>(sha256(readFile(file, what))); };
  struct stat status {};
  const bool settled = ::stat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
                       status.st_ctim.tv_sec + kSettled < std::time(nullptr);
  if (!settled) return *hash();
  const std::string identity = file.string() + " " + std::to_string(status.st_dev) + " " +
                               std::to_string(status.st_ino) + " " +
                               std::to_string(status.st_size) + " " + textOf(status.st_mtim) + " " +
                               textOf(status.st_ctim);
  return *keptContent<std::string>("hash", identity, hash);
}

}  // namespace cdiff::core

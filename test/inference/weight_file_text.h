// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Weight files as bytes for tests: built by hand, so that they can have every fault.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

inline void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

inline std::string readBytes(const std::filesystem::path& file) {
  return core::readFile(file, "test file");
}

inline std::string littleEndian(std::uint64_t value) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>((value >> (8 * i)) & 255);
  return bytes;
}

inline std::string floatBytes(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

/// Length, header, data.
inline std::string weightFile(const std::string& header, const std::string& data) {
  return littleEndian(header.size()) + header + data;
}

/// Text of the InputError that the action throws; "no error" without one.
inline std::string inputErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace cdiff::test

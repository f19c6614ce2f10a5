// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/clock.h"

#include <array>
#include <ctime>

namespace cdiff::core {
namespace {

std::string now(const char* format) {
  const std::time_t time = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&time, &local);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), format, &local);
  return text.data();
}

}  // namespace

std::string timeText() { return now("%Y-%m-%d %H:%M:%S"); }

std::string timeForFileName() { return now("%Y%m%d_%H%M%S"); }

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/worker_part.h"

#include <cstddef>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::cli {

std::vector<std::string> partOf(const std::vector<std::string>& ids, const std::string& part) {
  if (part.empty()) return ids;
  const std::size_t slash = part.find('/');
  const auto number = [&](const std::string& text) -> std::size_t {
    constexpr std::size_t kMostDigits = 9;
    const bool plain = !text.empty() && text.size() <= kMostDigits &&
                       text.find_first_not_of("0123456789") == std::string::npos;
    if (!plain)
      throw core::InputError("--part '" + part + "': expected I/N, two whole numbers, as 0/4");
    return std::stoul(text);
  };
  const std::size_t first = number(part.substr(0, slash));
  const std::size_t step = number(slash == std::string::npos ? "" : part.substr(slash + 1));
  if (first >= step)
    throw core::InputError("--part '" + part + "': expected I/N with I below N, as 0/4");
  std::vector<std::string> chosen;
  for (std::size_t i = first; i < ids.size(); i += step) chosen.push_back(ids[i]);
  return chosen;
}

}  // namespace cdiff::cli

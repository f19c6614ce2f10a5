// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/holder.h"

#include <unistd.h>

#include <array>
#include <cstddef>

#include "core/clock.h"
#include "core/host.h"
#include "core/markup.h"
#include "core/text.h"

namespace cdiff::core {

std::string holderSignature(const std::string& program) {
  return "host: " + hostName() + "\nprocess: " + std::to_string(::getpid()) +
         "\nprogram: " + program + "\nsince: " + timeText() + "\n";
}

std::map<std::string, std::string> holderFacts(int descriptor) {
  std::array<char, 1024> buffer{};
  const ssize_t count = ::pread(descriptor, buffer.data(), buffer.size(), 0);
  std::map<std::string, std::string> facts;
  for (const std::string& line :
       splitText({buffer.data(), static_cast<std::size_t>(count > 0 ? count : 0)}, '\n')) {
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) facts[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return facts;
}

std::string holderText(const std::map<std::string, std::string>& facts) {
  constexpr std::size_t kMostLetters = 80;
  const auto value = [&](const std::string& key) {
    const auto found = facts.find(key);
    return found == facts.end() ? "" : cutText(found->second, kMostLetters);
  };
  return "'" + value("program") + "', process " + value("process") + " on host " + value("host") +
         ", since " + value("since");
}

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Writes the result of a session that ended before any of its nodes could: scripts/session calls
/// it with "error" or "interrupted", who is to blame, why, and the arguments of session.launch.
#include <iostream>
#include <map>

#include "core/program.h"
#include "node_graph/session_files.h"

int main(int argc, char** argv) {
  constexpr int kFirstArgument = 4;
  if (argc < kFirstArgument) {
    std::cerr << "usage: unstarted_session error|interrupted SOURCE TEXT [NAME:=VALUE]...\n";
    return cdiff::core::ExitCode::kBadInput;
  }
  std::map<std::string, std::string> arguments;
  for (int i = kFirstArgument; i < argc; ++i) {
    const std::string text = argv[i];
    const std::size_t sign = text.find(":=");
    if (sign != std::string::npos) arguments[text.substr(0, sign)] = text.substr(sign + 2);
  }
  using cdiff::traffic::SessionStatus;
  const bool interrupted = std::string(argv[1]) == "interrupted";
  return cdiff::node_graph::writeUnstartedResult(
      cdiff::node_graph::Parameters(arguments),
      interrupted ? SessionStatus::kInterrupted : SessionStatus::kError, {0, argv[2], argv[3]});
}

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// What this binary was built from and runs on, for the record of a session.

/// Version of the package, "unknown" when the build did not give one.
std::string packageVersion();
/// Git revision at configure time, or "unknown".
std::string packageRevision();
/// (name, version) of the libraries and the compiler that decide results.
std::vector<std::pair<std::string, std::string>> libraryVersions();
/// Model name of the processor, or "unknown".
std::string processorModel();
/// Instruction set that the binary was compiled for, e.g. "x86-64 baseline".
std::string instructionSet();

/// Text of session.yaml: the resolved scenario, seeds, and what it ran on (package, simulator,
/// network, libraries, processor).
std::string sessionYaml(const session::SessionSetup& setup, const RunFacts& facts);

// Reads session.yaml back.

/// Values above the scenario, by "key" or "section.key", as written.
std::map<std::string, std::string> sessionFacts(const std::string& yaml);

/// What a session.yaml says.
struct SessionFile {
  std::map<std::string, std::string> facts;  ///< sessionFacts
  session::ScenarioOptions scenario;         ///< resolved, SI units
};

/// Throws InputError naming file and key for what no session wrote.
SessionFile readSessionYaml(const std::filesystem::path& file);

}  // namespace cdiff::record

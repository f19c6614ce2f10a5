// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "session/scenario_options.h"
#include "session/steering.h"

namespace cdiff::session {

/// The steering that a session recorded or a scenario lists: of a result folder, its summary.json,
/// or a scenario file. Throws InputError naming the file for one that holds none, and for the
/// record of a session that the wall clock paced (real_time_factor), which cannot be repeated.
std::vector<SteeringEntry> readSteering(const std::filesystem::path& source);

/// Throws InputError for the record `source` of such a session.
[[noreturn]] void refusePaced(const std::filesystem::path& source);

/// Of which session a record of steering is.
struct SteeredSession {
  std::string scenario;  ///< name; empty where the source is no record
  std::int64_t seed = 0;
  std::string version;  ///< of the package that recorded it; empty where it does not say
};
/// Of a result folder or its summary.json; of any other source none.
SteeredSession steeredSession(const std::filesystem::path& source);
/// Throws InputError naming `source` where `recorded` is another session than `options` asks for,
/// or by another version of the package than `version`: it would not repeat to the same bytes.
void requireSameSession(const std::filesystem::path& source, const SteeredSession& recorded,
                        const ScenarioOptions& options, const std::string& version);

/// The resolved scenario in the text of a session.yaml, whose last group it is, as YAML. Throws
/// InputError naming `file` where it has none.
std::string recordedScenario(const std::string& text, const std::string& file);

/// The scenario that repeats the session of a result folder with what was steered in it: the
/// resolved scenario with the list `steering`, an entry a line, as YAML. Throws InputError as
/// readSteering, and for a folder without session.yaml.
std::string steeredScenario(const std::filesystem::path& result);

}  // namespace cdiff::session

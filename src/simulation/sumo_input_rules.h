// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cdiff::simulation {

// What users may give to SUMO. SUMO writes files that its input names (devices of vehicles,
// detectors, probes, ...), over whatever is there, and reads further files that it includes; so
// only elements and keys that are known to do neither get through. Errors name the file as `name`
// says ("demand file 'a.rou.xml'"), the line, the element and the key.

/// Vehicles, persons and containers with their types, routes and stops, and parameters of vehicles
/// that name no file. Throws InputError.
void requireHarmlessDemand(std::string_view text, const std::string& name);

/// Roads, junctions and signals: what netconvert writes into a network. Throws InputError.
void requireHarmlessNetwork(std::string_view text, const std::string& name);

/// SUMO takes a comma in a path for the start of another file and replaces ${NAME} by a variable of
/// the environment. Throws InputError where the path holds either.
void requirePlainPath(const std::filesystem::path& file, const std::string& name);

}  // namespace cdiff::simulation

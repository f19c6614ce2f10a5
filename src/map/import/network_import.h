// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::map {

// Runs netconvert as a child process that ends with this one and within a time limit.

/// Environment variable that replaces the limit below [s].
inline constexpr const char* kNetconvertLimitVariable = "E2E_CDIFF_NETCONVERT_LIMIT";
/// Wall time that netconvert may take [s].
inline constexpr double kNetconvertLimit = 120.0;

/// Runs netconvert with these arguments; SUMO_HOME is core::sumoHome(). `subject` names in errors
/// what is converted ("network 'a.xodr'"). Throws InputError that quotes netconvert, or says that
/// it took longer than the limit or which signal ended it, and Interrupted when a stop is requested
/// meanwhile (core/program.h).
void runNetconvert(const std::vector<std::string>& arguments, const std::string& subject);

/// `vendor` in the header of OpenDRIVE files that this package writes. They are in the map frame.
inline constexpr const char* kOpenDriveVendor = "e2e_cdiff";

// Converts OpenDRIVE and OpenStreetMap files into SUMO network text with SUMO's netconvert and the
// package's type maps. The text holds no date and no paths.

/// netconvert shifts the network into positive coordinates, but not a file of kOpenDriveVendor.
/// Some roads get a limit (map/import/road_type_speeds.h). Throws as runNetconvert does.
std::string convertOpenDrive(const std::filesystem::path& source);

/// Only roads for cars, simplified: points that merely shape an edge do not split it, and junctions
/// or lights near each other are joined. Throws as convertOpenDrive does.
std::string convertOpenStreetMap(const std::filesystem::path& source);

/// A network that SUMO 1.15 can load, made by importNetwork from whatever the user gave.
struct ImportedNetwork {
  std::filesystem::path file;  ///< network that SUMO 1.15 loads (in the cache, or the input itself
                               ///< if nothing changed)
  std::filesystem::path source;      ///< what the user gave
  std::string source_sha256;         ///< SHA-256 of the input's content
  std::string text;                  ///< content of `file`
  std::vector<std::string> changes;  ///< one sentence each; empty when nothing was changed
};

/// The file that `source` stands for: a path, or the name of a network shipped in networks/. Throws
/// InputError naming what is wrong, with the nearest shipped name.
std::filesystem::path networkFile(const std::string& source);

/// Imports a network: *.net.xml of any SUMO version (not compressed), *.xodr, *.osm, or the name of
/// a network shipped in networks/. Drops vehicle classes that SUMO 1.15 does not know, converts
/// OpenDRIVE and OpenStreetMap with netconvert, and caches the result by the hash of the input; a
/// file of the cache that is not as it was stored is made again.
/// Called when a session is set up and by `cdiff import`. Throws InputError naming the file and
/// what is wrong (missing, not a network, netconvert's own message).
ImportedNetwork importNetwork(const std::string& source);

}  // namespace cdiff::map

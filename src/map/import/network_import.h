// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::map {

/// Makes any given network usable by SUMO 1.15: drops vehicle classes that it does not know,
/// converts OpenDRIVE and OpenStreetMap through netconvert, and caches the result by the hash of
/// the input's content. The changes are named in the record.
struct ImportedNetwork {
  std::filesystem::path file;  ///< network that SUMO 1.15 loads (in the cache, or the input itself
                               ///< if nothing changed)
  std::filesystem::path source;      ///< what the user gave
  std::string source_sha256;         ///< SHA-256 of the input's content
  std::string text;                  ///< content of `file`
  std::vector<std::string> changes;  ///< one sentence each; empty when nothing was changed
};

/// The file that `source` stands for: a path, or the name of a shipped network. Throws InputError.
std::filesystem::path networkFile(const std::string& source);

/// `source`: *.net.xml (also gzip-free older or newer), *.xodr, *.osm, or the name of a network
/// shipped in networks/. Throws InputError naming the file and what is wrong (missing, not a
/// network, netconvert's own message).
ImportedNetwork importNetwork(const std::string& source);

}  // namespace cdiff::map

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Small networks for tests, made by netconvert from plain nodes and edges into a temporary folder.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "core/file.h"
#include "e2e_cdiff/map/road_network.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

/// A network on disk and in memory.
struct SumoNetwork {
  std::filesystem::path file;
  map::RoadNetwork network;
};

/// `nodes` and `edges` are the elements inside <nodes> and <edges>; `options` are added to
/// netconvert's command line.
inline SumoNetwork makeSumoNetwork(const TemporaryFolder& folder, const std::string& nodes,
                                   const std::string& edges, const std::string& options = "") {
  const std::string base = (folder.path() / "net").string();
  std::ofstream(base + ".nod.xml") << "<nodes>" << nodes << "</nodes>";
  std::ofstream(base + ".edg.xml") << "<edges>" << edges << "</edges>";
  const std::string command =
      "netconvert --xml-validation never --offset.disable-normalization true -n " + base +
      ".nod.xml -e " + base + ".edg.xml -o " + base + ".net.xml " + options + " > " + base +
      ".log 2>&1";
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("netconvert: " + core::readFile(base + ".log", "netconvert's log"));
  }
  const std::filesystem::path file = base + ".net.xml";
  return {file, map::RoadNetwork::fromText(core::readFile(file, "network"), file.string())};
}

}  // namespace cdiff::test

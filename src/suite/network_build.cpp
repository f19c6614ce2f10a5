// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/network_build.h"

#include <vector>

#include "core/file.h"
#include "map/netconvert.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;

/// Without "<!-- generated on ... -->" and what it encloses, and without blank lines in a row.
std::string withoutComment(const std::string& text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end == std::string::npos) return text;
  std::size_t rest = text.find_first_not_of('\n', end + 3);
  if (rest == std::string::npos) rest = text.size();
  return text.substr(0, begin) + "\n" + text.substr(rest);
}

/// Writes a source and names it on netconvert's command line.
void addSource(const fs::path& file, const char* option, const std::string& text,
               std::vector<std::string>& command) {
  if (text.empty()) return;
  core::writeFileAtomically(file, text);
  command.insert(command.end(), {option, file.string()});
}

}  // namespace

std::string buildNetwork(const RoadPlan& plan, const fs::path& folder) {
  fs::create_directories(folder);
  const std::string base = (folder / plan.name).string();
  const fs::path raw = base + ".raw.net.xml";
  std::vector<std::string> command = {
      "-c", (core::shareFolder() / "networks" / "netconvert.netccfg").string()};
  addSource(base + ".nod.xml", "--node-files", nodesXml(plan), command);
  addSource(base + ".edg.xml", "--edge-files", edgesXml(plan), command);
  addSource(base + ".con.xml", "--connection-files", connectionsXml(plan), command);
  command.insert(command.end(), {"--output-file", raw.string()});
  map::runNetconvert(command, "network '" + plan.name + "'");
  const std::string text = withoutComment(core::readFile(raw, "network"));
  core::writeFileAtomically(base + ".net.xml", text);
  fs::remove(raw);
  return text;
}

}  // namespace cdiff::suite

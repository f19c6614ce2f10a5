// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff import`: makes a SUMO, OpenDRIVE or OpenStreetMap file usable.
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "map/import/network_import.h"
#include "map/lane_graph.h"
#include "page/pictures/edge_map.h"

namespace cdiff::cli {
namespace {

void importOne(const std::string& source, const std::string& output, const std::string& picture) {
  if (!picture.empty() && !core::endsWith(picture, ".svg"))
    throw core::InputError("--picture '" + picture + "' is not called *.svg, which it will be");
  const map::ImportedNetwork imported = map::importNetwork(source);
  const map::RoadNetwork network = map::RoadNetwork::fromText(imported.text, source);
  const map::DrivableArea area(network);
  std::cout << "source    " << imported.source.string() << "\n"
            << "sha256    " << imported.source_sha256 << "\n"
            << "network   " << imported.file.string() << "\n"
            << "lanes     " << network.lanes().size() << "\n"
            << "edges     " << network.edgeIds().size() << "\n"
            << "junctions " << network.junctions().size() << "\n"
            << "levels    " << area.levelCount() << "\n";
  const std::string turns = map::turnRoundText(network);
  if (!turns.empty()) std::cout << "turns     " << turns << "\n";
  for (const std::string& change : imported.changes) std::cout << "change    " << change << "\n";
  if (!output.empty()) core::writeFileAtomically(output, imported.text);
  if (!picture.empty()) core::writeFileAtomically(picture, page::edgeMapSvg(network, std::nullopt));
  if (!output.empty()) std::cout << "output    " << output << "\n";
  if (!picture.empty()) std::cout << "picture   " << picture << "\n";
}

}  // namespace

void addImportCommand(CLI::App& program, int& exit_code) {
  auto source = std::make_shared<std::string>();
  auto output = std::make_shared<std::string>();
  auto picture = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("import",
                                             "Make a SUMO network, an OpenDRIVE or an "
                                             "OpenStreetMap file usable, and say what was changed");
  command->add_option("source", *source, "*.net.xml, *.xodr, *.osm or a shipped network")
      ->required();
  command->add_option("--output", *output, "Also write the network to this file");
  command->add_option("--picture", *picture,
                      "Also write a map with the names of all edges to this file (*.svg)");
  command->callback([source, output, picture, &exit_code] {
    importOne(*source, *output, *picture);
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli

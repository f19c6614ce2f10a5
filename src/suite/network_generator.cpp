// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/network_generator.h"

#include <array>
#include <vector>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "map/import/network_import.h"
#include "suite/network_kinds.h"

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

double drawSmallSpeed(Draws& draws) {
  return draws.pick(std::array<double, 3>{8.33, 11.11, 13.89});
}

double drawLargeSpeed(Draws& draws) {
  return draws.pick(std::array<double, 4>{11.11, 13.89, 16.67, 19.44});
}

Line ArmShape::draw(const Eigen::Vector2d& start, double heading, double speed,
                    Draws& draws) const {
  constexpr double kStraight = 45.0;  // before the bend [m]
  constexpr double kBendShare = 0.7;
  constexpr double kSideways = 3.0;  // [m/s^2]
  RoadLine road(start, heading);
  road.straight(draws.uniform(kStraight, kStraight + 20.0));
  const double length = draws.uniform(60.0, 90.0);
  const double radius = draws.uniform(1.0, 2.0) * speed * speed / kSideways;
  const double angle = core::degreesToRadians(draws.uniform(15.0, 50.0));
  if (draws.chance(kBendShare)) road.arc(radius, side_ * angle);
  road.straight(length);
  const double height = draws.sign() * draws.uniform(2.0, 5.0);
  return elevation_ ? climbing(road.points(), kStraight, height) : road.points();
}

void addArm(const ArmPlan& arm, RoadPlan& plan) {
  plan.nodes.push_back({arm.name, arm.line.back(), ""});
  plan.edges.push_back({arm.name + "_in", arm.name, arm.inner, arm.lanes, arm.speed, arm.priority,
                        reversed(arm.line), false});
  plan.edges.push_back({arm.name + "_out", arm.inner, arm.name, arm.lanes, arm.speed, arm.priority,
                        arm.line, false});
}

RoadPlan drawNetwork(const NetworkSpec& spec, Draws& draws) {
  switch (spec.kind) {
    case NetworkKind::kRoundabout:
      return drawRoundabout(spec, draws);
    case NetworkKind::kMerge:
      return drawMerge(spec, draws);
    case NetworkKind::kDistrict:
      return drawDistrict(spec, draws);
    case NetworkKind::kCrossing:
      break;
  }
  return drawCrossing(spec, draws);
}

}  // namespace cdiff::suite

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/demand_file.h"

#include <algorithm>
#include <pugixml.hpp>
#include <unordered_map>

#include "core/file.h"
#include "core/text.h"

namespace cdiff::session {
namespace {

std::optional<double> optionalNumber(const pugi::xml_node& node, const char* attribute) {
  return core::parseNumber(node.attribute(attribute).value());
}

double numberOf(const pugi::xml_node& node, const char* attribute, double absent) {
  return optionalNumber(node, attribute).value_or(absent);
}

/// Mean time between two vehicles of a flow [s], 0 where it has none. "exp(RATE)" draws the times.
double periodOf(const pugi::xml_node& flow) {
  const std::string text = flow.attribute("period").value();
  if (text.rfind("exp(", 0) != 0 || text.back() != ')') return numberOf(flow, "period", 0.0);
  const double rate = core::parseNumber(text.substr(4, text.size() - 5)).value_or(0.0);
  return rate > 0.0 ? 1.0 / rate : 0.0;
}

/// Vehicles of a flow from `begin` to `end` [s].
double vehiclesOfFlow(const pugi::xml_node& flow, double begin, double end) {
  const double from = numberOf(flow, "begin", 0.0);
  const double until = std::max(numberOf(flow, "end", 86400.0), from + 1e-3);
  const double share = std::max(0.0, std::min(end, until) - std::max(begin, from));
  const double period = periodOf(flow);
  if (flow.attribute("number")) return numberOf(flow, "number", 0.0) * share / (until - from);
  if (period > 0.0) return share / period;
  return share * (numberOf(flow, "vehsPerHour", 0.0) / 3600.0 + numberOf(flow, "probability", 0.0));
}

DemandStop stopOf(const pugi::xml_node& node) {
  DemandStop stop;
  stop.lane = node.attribute("lane").value();
  stop.edge = stop.lane.empty() ? node.attribute("edge").value()
                                : stop.lane.substr(0, stop.lane.rfind('_'));
  stop.begin = optionalNumber(node, "startPos");
  stop.end = optionalNumber(node, "endPos");
  stop.duration = optionalNumber(node, "duration");
  stop.until = optionalNumber(node, "until");
  return stop;
}

}  // namespace

bool hasDemandFile(const ScenarioOptions& options) {
  return options.demand != "generated" && options.demand != "none";
}

/// The parsed file, and where in it a vehicle or flow, or a route, is.
struct DemandFile::Content {
  pugi::xml_document document;
  std::unordered_map<std::string, pugi::xml_node> vehicles;
  std::unordered_map<std::string, pugi::xml_node> routes;

  pugi::xml_node vehicle(const std::string& id) const {
    const auto found = vehicles.find(id);
    if (found != vehicles.end()) return found->second;
    const auto flow = vehicles.find(id.substr(0, id.rfind('.')));
    const bool is_flow = flow != vehicles.end() && std::string(flow->second.name()) == "flow";
    return is_flow ? flow->second : pugi::xml_node();
  }

  /// The route that a vehicle names or holds.
  pugi::xml_node route(const pugi::xml_node& vehicle) const {
    const auto named = routes.find(vehicle.attribute("route").value());
    return named != routes.end() ? named->second : vehicle.child("route");
  }
};

DemandFile::DemandFile(const std::string& file) : content_(std::make_unique<Content>()) {
  const std::string text = core::readFile(file, "demand file");
  content_->document.load_buffer(text.data(), text.size());
  for (const pugi::xml_node& element : content_->document.child("routes").children()) {
    const std::string kind = element.name();
    const std::string id = element.attribute("id").value();
    if (kind == "vehicle" || kind == "trip" || kind == "flow")
      content_->vehicles.emplace(id, element);
    if (kind == "route") content_->routes.emplace(id, element);
  }
}

DemandFile::DemandFile(DemandFile&&) noexcept = default;
DemandFile::~DemandFile() = default;

double DemandFile::vehicles(double begin, double end) const {
  double asked = 0.0;
  for (const pugi::xml_node& element : content_->document.child("routes").children()) {
    const std::string kind = element.name();
    const double departure = numberOf(element, "depart", -1.0);
    if (kind == "flow") asked += vehiclesOfFlow(element, begin, end);
    if (kind == "vehicle" || kind == "trip") asked += departure >= begin && departure <= end;
  }
  return asked;
}

std::vector<std::string> DemandFile::routeOf(const std::string& vehicle) const {
  std::vector<std::string> edges;
  const pugi::xml_node route = content_->route(content_->vehicle(vehicle));
  for (const std::string& edge : core::splitText(route.attribute("edges").value(), ' ')) {
    if (!edge.empty()) edges.push_back(edge);
  }
  return edges;
}

std::vector<DemandStop> DemandFile::stopsOf(const std::string& vehicle) const {
  std::vector<DemandStop> stops;
  const pugi::xml_node node = content_->vehicle(vehicle);
  for (const pugi::xml_node& parent : {content_->route(node), node}) {
    for (const pugi::xml_node& stop : parent.children("stop")) stops.push_back(stopOf(stop));
  }
  return stops;
}

}  // namespace cdiff::session

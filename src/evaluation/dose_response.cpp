// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/dose_response.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/comparison/comparison.h"
#include "metrics/formulas/rank_correlation.h"

namespace cdiff::evaluation {
namespace {

using core::InputError;

constexpr std::size_t kLeastDoses = 3;

/// "target_speed_5.5" as ("target_speed", 5.5); nullopt for another name.
std::optional<std::pair<std::string, double>> doseOf(const std::string& variant) {
  const std::size_t end = variant.rfind('_');
  if (end == std::string::npos || end == 0) return std::nullopt;
  const std::optional<double> dose = core::parseNumber(variant.substr(end + 1));
  if (!dose) return std::nullopt;
  return std::pair(variant.substr(0, end), *dose);
}

using Runs = std::vector<const RunRecord*>;

/// The complete runs of one axis, by dose.
struct Axis {
  std::string name;
  std::map<double, Runs> runs;
};

std::vector<Axis> axesOf(const std::vector<RunRecord>& records) {
  std::vector<Axis> axes;
  for (const RunRecord& record : records) {
    const auto dose = doseOf(record.factors.at("variant"));
    if (!dose || !record.complete()) continue;
    auto axis = std::find_if(axes.begin(), axes.end(),
                             [&](const Axis& known) { return known.name == dose->first; });
    if (axis == axes.end()) axis = axes.insert(axes.end(), {dose->first, {}});
    axis->runs[dose->second].push_back(&record);
  }
  axes.erase(std::remove_if(axes.begin(), axes.end(),
                            [](const Axis& axis) { return axis.runs.size() < kLeastDoses; }),
             axes.end());
  return axes;
}

void requireOneSystem(const std::vector<RunRecord>& records) {
  for (const char* factor : {"ego_planner", "cbv_planner", "mode", "method"}) {
    std::set<std::string> levels;
    for (const RunRecord& record : records)
      if (doseOf(record.factors.at("variant"))) levels.insert(record.factors.at(factor));
    if (levels.size() > 1)
      throw InputError("the doses were given to several systems: factor '" + std::string(factor) +
                       "' has the levels " + core::joinText({levels.begin(), levels.end()}, ", ") +
                       "; evaluate one system at a time");
  }
}

/// Within a dose: profiles may be what the doses of an axis are.
void requireOneProfile(const std::vector<RunRecord>& records) {
  std::map<std::string, std::set<std::string>> profiles;
  for (const RunRecord& record : records) {
    const std::string& variant = record.factors.at("variant");
    if (doseOf(variant)) profiles[variant].insert(record.factors.at("guidance_profile"));
  }
  for (const auto& [variant, levels] : profiles) {
    if (levels.size() > 1)
      throw InputError("dose '" + variant + "' was given with the guidance profiles " +
                       core::joinText({levels.begin(), levels.end()}, ", ") +
                       "; evaluate one of them at a time");
  }
}

/// The scenarios that have a run at every dose.
std::set<std::string> sharedRoutes(const Axis& axis) {
  std::map<std::string, std::set<double>> doses;
  for (const auto& [dose, runs] : axis.runs)
    for (const RunRecord* run : runs) doses[run->factors.at("scenario")].insert(dose);
  std::set<std::string> shared;
  for (const auto& [route, at] : doses)
    if (at.size() == axis.runs.size()) shared.insert(route);
  return shared;
}

Runs runsOn(const Runs& runs, const std::set<std::string>& routes) {
  Runs chosen;
  for (const RunRecord* run : runs)
    if (routes.count(run->factors.at("scenario")) > 0) chosen.push_back(run);
  return chosen;
}

/// What each route adds at one dose; routes without the measure add nothing.
RouteSums sumsOf(const Runs& runs, const std::string& measure,
                 const std::set<std::string>& routes) {
  const metrics::PoolingRule rule = poolingOfMeasure(measure);
  ClusterSums clusters(measure, rule, knowDistances(runs, rule, measure));
  for (const RunRecord* run : runs) clusters.add(*run, run->factors.at("scenario"));
  RouteSums sums;
  for (const std::string& route : routes) {
    const auto at = clusters.byCluster().find(route);
    sums.push_back(at != clusters.byCluster().end() ? at->second : RouteSum{});
  }
  return sums;
}

/// Correlation of the doses with what the drawn routes (by index) give at each.
std::optional<double> correlationOf(const std::vector<double>& doses,
                                    const std::vector<RouteSums>& sums,
                                    const std::uint32_t* first) {
  std::vector<double> responses;
  for (const RouteSums& routes : sums) {
    RouteSums drawn;
    for (std::size_t i = 0; i < routes.size(); ++i) drawn.push_back(routes[first[i]]);
    const std::optional<double> value = pooledValue(drawn);
    if (!value) return std::nullopt;
    responses.push_back(*value);
  }
  return metrics::rankCorrelation(doses, responses);
}

DoseResponse responseOf(const Axis& axis, const std::string& measure, RouteBootstrap& bootstrap) {
  const std::set<std::string> routes = sharedRoutes(axis);
  DoseResponse response{axis.name, measure, routes.size(), {}, std::nullopt, std::nullopt};
  std::vector<double> doses;
  std::vector<RouteSums> sums;
  for (const auto& [dose, all] : axis.runs) {
    const Runs runs = runsOn(all, routes);
    response.doses.push_back({dose, pooledEstimate(runs, measure, bootstrap)});
    doses.push_back(dose);
    sums.push_back(sumsOf(runs, measure, routes));
  }
  const auto correlation = [&](const std::uint32_t* first) {
    return correlationOf(doses, sums, first);
  };
  std::vector<std::uint32_t> each(routes.size());
  std::iota(each.begin(), each.end(), 0U);
  response.rank_correlation = correlation(each.data());
  response.interval = bootstrap.interval(routes.size(), correlation);
  return response;
}

std::string correlationText(const DoseResponse& response) {
  if (!response.rank_correlation) return "none: all responses are equal, or one is unknown";
  const std::string interval =
      showsIntervals(response.routes) ? intervalText(response.interval, 2) : "";
  return core::formatFixed(*response.rank_correlation, 2) + interval;
}

/// The responses of one axis: those from `first` to `end`.
std::string axisMarkdown(const DoseResponse* first, const DoseResponse* end) {
  std::string head = "| " + first->axis + " |";
  std::string rule = "|---|";
  std::string last = "| rank correlation |";
  for (const DoseResponse* response = first; response != end; ++response) {
    head += " " + response->measure + " |";
    rule += "---|";
    last += " " + correlationText(*response) + " |";
  }
  std::string rows;
  for (std::size_t i = 0; i < first->doses.size(); ++i) {
    rows += "| " + core::formatNumber(first->doses[i].dose) + " |";
    for (const DoseResponse* response = first; response != end; ++response)
      rows += " " + estimateText(response->doses[i].response, 2, showsIntervals(response->routes)) +
              " |";
    rows += "\n";
  }
  return head + "\n" + rule + "\n" + rows + last + "\n\n" + countText(first->routes, "route") +
         " driven at every dose.\n\n";
}

}  // namespace

std::vector<DoseResponse> doseResponses(const std::vector<RunRecord>& records,
                                        const std::vector<std::string>& measures) {
  checkMeasureNames(measures);
  requireOneSystem(records);
  requireOneProfile(records);
  const std::vector<Axis> axes = axesOf(records);
  if (axes.empty())
    throw InputError(
        "no three variants are the doses of one axis: name them AXIS_NUMBER, as target_speed_3, "
        "target_speed_5 and target_speed_8");
  RouteBootstrap bootstrap;
  std::vector<DoseResponse> responses;
  for (const Axis& axis : axes)
    for (const std::string& measure : measures)
      responses.push_back(responseOf(axis, measure, bootstrap));
  return responses;
}

std::string doseMarkdown(const std::vector<DoseResponse>& responses) {
  std::string text;
  for (std::size_t first = 0; first < responses.size();) {
    std::size_t end = first;
    while (end < responses.size() && responses[end].axis == responses[first].axis) ++end;
    text += axisMarkdown(responses.data() + first, responses.data() + end);
    first = end;
  }
  return text;
}

}  // namespace cdiff::evaluation

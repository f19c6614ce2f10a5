// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/scenario_options.h"

namespace cdiff::session {

/// A stop that a demand file orders, as SUMO's <stop> has it: positions along the lane [m],
/// negative from its end, times on SUMO's clock [s].
struct DemandStop {
  std::string lane;  ///< where it is; empty where the file names an edge or a stopping place
  std::string edge;  ///< of the lane; empty at a stopping place
  std::optional<double> begin;     ///< startPos
  std::optional<double> end;       ///< endPos
  std::optional<double> duration;  ///< how long it stands [s]
  std::optional<double> until;     ///< it stands at least until then
};

/// Whether the scenario's background traffic comes from a file.
bool hasDemandFile(const ScenarioOptions& options);

/// The SUMO route file that gives a scenario's background traffic: how many vehicles it asks for,
/// their routes and their stops. Vehicles of a flow are named FLOW.NUMBER.
class DemandFile {
 public:
  /// Throws InputError naming the file where it cannot be read.
  explicit DemandFile(const std::string& file);
  DemandFile(DemandFile&&) noexcept;
  ~DemandFile();

  /// Vehicles that depart from `begin` to `end` on SUMO's clock [s].
  double vehicles(double begin, double end) const;
  /// Edges of a vehicle in driving order; empty for an unknown vehicle and one with two ends only.
  std::vector<std::string> routeOf(const std::string& vehicle) const;
  /// Stops of a vehicle, in the file's order.
  std::vector<DemandStop> stopsOf(const std::string& vehicle) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace cdiff::session

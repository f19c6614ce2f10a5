// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// plans.csv: planned against driven states of CBVs (map frame, SI units), a row per decision and
/// 0.4 s of the plan.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/plan_log.h"

namespace cdiff::record {

/// Driven cells stay empty where the vehicle was not driven until then. At 0 s both states are
/// where the vehicle was.
std::string plansCsv(const PlanLog& plans);

/// One row.
struct PlanRow {
  std::string vehicle_id;
  std::uint64_t tick = 0;  ///< of the decision
  double seconds = 0.0;    ///< since the decision
  WayPoint planned;
  std::optional<WayPoint> driven;
};

/// Rows in the file's order. Throws InputError naming file and line for anything else.
std::vector<PlanRow> readPlans(const std::filesystem::path& file);

}  // namespace cdiff::record

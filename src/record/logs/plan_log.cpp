// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/plan_log.h"

#include <algorithm>
#include <cmath>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::record {
namespace {

Waypoint waypointOf(const traffic::VehicleState& state) {
  return {state.position, state.heading, state.speed};
}

/// Linear between two states; `share` 0 gives `from`, 1 gives `to`.
Waypoint between(const Waypoint& from, const Waypoint& to, double share) {
  return {from.position + share * (to.position - from.position),
          from.heading + share * core::wrapAngle(to.heading - from.heading),
          from.speed + share * (to.speed - from.speed)};
}

using Memory = std::pmr::memory_resource*;

std::pmr::vector<Waypoint> pointsOf(const planning::PlannedAction& action, Memory memory) {
  std::pmr::vector<Waypoint> points(memory);
  points.reserve(action.rollout.size());
  for (const planning::RolloutPoint& point : action.rollout)
    points.push_back(waypointOf(point.state));
  return points;
}

std::pmr::vector<LoggedCandidate> candidatesOf(const planning::PlannedAction& action,
                                               Memory memory) {
  std::pmr::vector<LoggedCandidate> candidates(memory);
  candidates.reserve(action.candidates.size());
  for (const planning::PlannedCandidate& candidate : action.candidates) {
    const auto& places = candidate.places;
    candidates.push_back({{places.begin(), places.end(), memory}, candidate.score});
  }
  return candidates;
}

std::vector<double> mismatches(const VehiclePlans& vehicle) {
  std::vector<double> values;
  for (const LoggedPlan& plan : vehicle.plans) values.push_back(plan.state_mismatch);
  return values;
}

}  // namespace

double LoggedPlan::horizon() const {
  return static_cast<double>(points.size()) * traffic::kRolloutStep;
}

void PlanLog::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role != traffic::VehicleRole::kCbv) continue;
    plansOf(vehicle).driven.emplace_back(snapshot.tick, waypointOf(vehicle.state));
  }
  if (record.actions == nullptr) return;
  for (const planning::PlannedAction& action : *record.actions) {
    const traffic::Vehicle* vehicle = snapshot.find(action.vehicle_id);
    if (action.slot < 0 || action.rollout.empty() || vehicle == nullptr) continue;
    plansOf(*vehicle).plans.push_back({snapshot.tick, snapshot.time, waypointOf(vehicle->state),
                                       pointsOf(action, memory_), action.state_mismatch,
                                       candidatesOf(action, memory_)});
  }
}

VehiclePlans& PlanLog::plansOf(const traffic::Vehicle& vehicle) {
  const auto [known, added] = index_by_id_.emplace(vehicle.id, vehicles_.size());
  if (added) {
    vehicles_.push_back({vehicle.id, vehicle.dimensions, std::pmr::vector<LoggedPlan>(memory_),
                         std::pmr::vector<std::pair<std::uint64_t, Waypoint>>(memory_)});
  }
  return vehicles_[known->second];
}

const VehiclePlans* PlanLog::find(const std::string& vehicle_id) const {
  const auto found = index_by_id_.find(vehicle_id);
  return found == index_by_id_.end() ? nullptr : &vehicles_[found->second];
}

bool PlanLog::empty() const {
  return std::all_of(vehicles_.begin(), vehicles_.end(),
                     [](const VehiclePlans& vehicle) { return vehicle.plans.empty(); });
}

std::optional<Waypoint> PlanLog::drivenAfter(const VehiclePlans& vehicle, const LoggedPlan& plan,
                                             double seconds) const {
  const double ticks = seconds / simulation_step_;
  const auto whole = static_cast<std::uint64_t>(std::floor(ticks + 1e-6));
  const double share = std::max(0.0, ticks - static_cast<double>(whole));
  const std::uint64_t last = plan.tick + whole + (share > 1e-6 ? 1 : 0);
  // At the decision that selects a CBV it is not driven yet: its first driven tick is the next one.
  const auto& driven = vehicle.driven;
  const auto begin =
      std::lower_bound(driven.begin(), driven.end(), plan.tick,
                       [](const auto& state, std::uint64_t tick) { return state.first < tick; });
  if (begin == driven.end() || begin->first > plan.tick + 1) return std::nullopt;
  if (last < begin->first) return plan.start;
  const auto index = static_cast<std::ptrdiff_t>(last - begin->first);
  if (driven.end() - begin <= index || (begin + index)->first != last) return std::nullopt;
  const auto& [tick, state] = *(begin + index);
  if (share <= 1e-6) return state;
  const Waypoint& before = index > 0 ? (begin + index - 1)->second : plan.start;
  return between(before, state, share);
}

const Waypoint* plannedAfter(const LoggedPlan& plan, double seconds) {
  const auto row = static_cast<std::size_t>(std::lround(seconds / traffic::kRolloutStep));
  return row >= 1 && row <= plan.points.size() ? &plan.points[row - 1] : nullptr;
}

std::vector<double> PlanLog::displacements(const VehiclePlans& vehicle, double seconds) const {
  std::vector<double> values;
  for (const LoggedPlan& plan : vehicle.plans) {
    const Waypoint* planned = plannedAfter(plan, seconds);
    if (planned == nullptr) continue;
    const std::optional<Waypoint> driven = drivenAfter(vehicle, plan, seconds);
    if (driven) values.push_back((planned->position - driven->position).norm());
  }
  return values;
}

const LoggedPlan* PlanLog::drivenPlanNear(const VehiclePlans& vehicle, double time) const {
  const LoggedPlan* best = nullptr;
  for (const LoggedPlan& plan : vehicle.plans) {
    const bool nearer =
        best == nullptr || std::abs(plan.time - time) < std::abs(best->time - time) - 1e-9;
    if (nearer && drivenAfter(vehicle, plan, plan.horizon())) best = &plan;
  }
  return best;
}

SampleSummary displacementSummary(const PlanLog& log, double seconds) {
  std::vector<double> values;
  for (const VehiclePlans& vehicle : log.vehicles()) {
    const std::vector<double> own = log.displacements(vehicle, seconds);
    values.insert(values.end(), own.begin(), own.end());
  }
  return summaryOf(values);
}

SampleSummary mismatchSummary(const PlanLog& log) {
  std::vector<double> values;
  for (const VehiclePlans& vehicle : log.vehicles()) {
    const std::vector<double> own = mismatches(vehicle);
    values.insert(values.end(), own.begin(), own.end());
  }
  return summaryOf(values);
}

SampleSummary mismatchSummary(const VehiclePlans& vehicle) {
  return summaryOf(mismatches(vehicle));
}

namespace {

constexpr const char* kHeader =
    "vehicle_id,tick,seconds,planned_x,planned_y,planned_heading,planned_speed,driven_x,driven_y,"
    "driven_heading,driven_speed\n";
constexpr std::size_t kStride = 4;  // rollout rows (of 0.1 s) from one CSV row to the next

void append(std::vector<std::string>& cells, const Waypoint& point) {
  for (const double value : {point.position.x(), point.position.y(), point.heading, point.speed})
    cells.push_back(core::formatNumber(value));
}

std::string rowOf(const std::string& vehicle, const LoggedPlan& plan, std::size_t steps,
                  const Waypoint& planned, const std::optional<Waypoint>& driven) {
  // Divided by 10 instead of multiplied by 0.1, which would give 1.2000000000000002 for 1.2.
  const double seconds = static_cast<double>(steps) / (1.0 / traffic::kRolloutStep);
  std::vector<std::string> cells = {vehicle, std::to_string(plan.tick),
                                    core::formatNumber(seconds)};
  append(cells, planned);
  if (driven) {
    append(cells, *driven);
  } else {
    cells.resize(cells.size() + 4);
  }
  return core::csvRow(cells);
}

std::optional<Waypoint> waypointOf(const std::vector<std::string>& cells, std::size_t first) {
  std::vector<double> values;
  for (std::size_t i = first; i < first + 4; ++i) {
    const auto value = core::parseNumber(cells[i]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return Waypoint{{values[0], values[1]}, values[2], values[3]};
}

std::optional<PlanRow> rowOf(std::string_view line) {
  const std::vector<std::string> cells = core::csvCells(line);
  if (cells.size() != 11) return std::nullopt;
  const auto tick = core::parseNumber(cells[1]);
  const auto seconds = core::parseNumber(cells[2]);
  const auto planned = waypointOf(cells, 3);
  const auto driven = waypointOf(cells, 7);
  const bool none = std::all_of(cells.begin() + 7, cells.end(),
                                [](const std::string& cell) { return cell.empty(); });
  if (!tick || *tick < 0.0 || !seconds || !planned || (!driven && !none)) return std::nullopt;
  return PlanRow{cells[0], static_cast<std::uint64_t>(*tick), *seconds, *planned, driven};
}

}  // namespace

std::string plansCsv(const PlanLog& plans) {
  std::string text = kHeader;
  for (const VehiclePlans& vehicle : plans.vehicles()) {
    for (const LoggedPlan& plan : vehicle.plans) {
      text += rowOf(vehicle.vehicle_id, plan, 0, plan.start, plan.start);
      for (std::size_t steps = kStride; steps <= plan.points.size(); steps += kStride) {
        const Waypoint& planned = plan.points[steps - 1];
        if (!planned.position.allFinite()) break;
        const double seconds = static_cast<double>(steps) * traffic::kRolloutStep;
        text += rowOf(vehicle.vehicle_id, plan, steps, planned,
                      plans.drivenAfter(vehicle, plan, seconds));
      }
    }
  }
  return text;
}

std::vector<PlanRow> readPlans(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "plans");
  const std::vector<core::CsvRow> lines = core::csvRows(text);
  if (text.rfind(kHeader, 0) != 0) {
    throw core::InputError("'" + file.string() + "' holds no plans; its first line must be " +
                           std::string(kHeader, std::char_traits<char>::length(kHeader) - 1));
  }
  std::vector<PlanRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto row = lines[i].ended ? rowOf(lines[i].text) : std::nullopt;
    if (!row) {
      throw core::InputError(file.string() + ":" + std::to_string(lines[i].line) +
                             ": no whole row of plans");
    }
    rows.push_back(*row);
  }
  return rows;
}

}  // namespace cdiff::record

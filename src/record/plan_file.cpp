// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/plan_file.h"

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::record {
namespace {

constexpr const char* kHeader =
    "vehicle_id,tick,seconds,planned_x,planned_y,planned_heading,planned_speed,driven_x,driven_y,"
    "driven_heading,driven_speed\n";
constexpr std::size_t kStride = 4;  // rollout steps from row to row

void append(std::vector<std::string>& cells, const WayPoint& point) {
  for (const double value : {point.position.x(), point.position.y(), point.heading, point.speed})
    cells.push_back(core::formatNumber(value));
}

std::string rowOf(const std::string& vehicle, const LoggedPlan& plan, std::size_t steps,
                  const WayPoint& planned, const std::optional<WayPoint>& driven) {
  // Divided by 10, not multiplied by 0.1: 1.2, not 1.2000000000000002.
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

std::optional<WayPoint> wayPointOf(const std::vector<std::string>& cells, std::size_t first) {
  std::vector<double> values;
  for (std::size_t i = first; i < first + 4; ++i) {
    const auto value = core::parseNumber(cells[i]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return WayPoint{{values[0], values[1]}, values[2], values[3]};
}

std::optional<PlanRow> rowOf(const std::string& line) {
  const std::vector<std::string> cells = core::csvCells(line);
  if (cells.size() != 11) return std::nullopt;
  const auto tick = core::parseNumber(cells[1]);
  const auto seconds = core::parseNumber(cells[2]);
  const auto planned = wayPointOf(cells, 3);
  if (!tick || *tick < 0.0 || !seconds || !planned) return std::nullopt;
  return PlanRow{cells[0], static_cast<std::uint64_t>(*tick), *seconds, *planned,
                 wayPointOf(cells, 7)};
}

}  // namespace

std::string plansCsv(const PlanLog& plans) {
  std::string text = kHeader;
  for (const VehiclePlans& vehicle : plans.vehicles()) {
    for (const LoggedPlan& plan : vehicle.plans) {
      text += rowOf(vehicle.vehicle_id, plan, 0, plan.start, plan.start);
      for (std::size_t steps = kStride; steps <= plan.points.size(); steps += kStride) {
        const WayPoint& planned = plan.points[steps - 1];
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
  const auto lines = core::splitText(core::readFile(file, "plans"), '\n');
  if (lines.empty() || lines.front() + "\n" != kHeader) {
    throw core::InputError("'" + file.string() + "' holds no plans; its first line must be " +
                           std::string(kHeader, std::char_traits<char>::length(kHeader) - 1));
  }
  std::vector<PlanRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto row = rowOf(lines[i]);
    if (!row) {
      throw core::InputError(file.string() + ":" + std::to_string(i + 1) + ": no row of plans");
    }
    rows.push_back(*row);
  }
  return rows;
}

}  // namespace cdiff::record

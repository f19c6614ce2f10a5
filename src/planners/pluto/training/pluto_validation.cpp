// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/training/pluto_validation.h"

#include <algorithm>
#include <utility>

#include "core/text.h"
#include "planners/pluto/pluto.h"

namespace cdiff::planners {
namespace {

constexpr std::int64_t kComparedSteps = 40;

using PlannedPlaces = Eigen::Matrix<float, Eigen::Dynamic, 2>;

std::int64_t comparedSteps(const PlutoTarget& target) {
  return std::min(kComparedSteps, target.steps);
}

/// Mean and last distance of a plan's places from those driven.
std::pair<double, double> distancesOf(const PlannedPlaces& plan, const PlutoTarget& target) {
  const std::int64_t steps = comparedSteps(target);
  const Eigen::VectorXf apart =
      (plan.topRows(steps) - target.future.leftCols<2>().topRows(steps)).rowwise().norm();
  return {static_cast<double>(apart.mean()), static_cast<double>(apart(steps - 1))};
}

PlannedPlaces atSpeed(double speed) {
  PlannedPlaces places = PlannedPlaces::Zero(kPlutoSteps, 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    places(i, 0) = static_cast<float>(speed * kPlutoPeriod * static_cast<double>(i + 1));
  return places;
}

}  // namespace

PlutoNetwork& PlutoValidation::networkOf(const PlutoWorld& world) {
  const auto known = networks_.find(&world);
  if (known != networks_.end()) return known->second;
  return networks_.emplace(&world, PlutoNetwork(model_, world.builder.pieces().all()))
      .first->second;
}

void PlutoValidation::add(const PlutoScene& scene, const PlutoPlace& place) {
  const PlutoMoment moment = scene.moment(place.decision, place.drive);
  const PlutoSceneBuilder& builder = scene.world().builder;
  const std::vector<ReferenceLine> lines = builder.linesOf(moment);
  const PlutoTarget target = plutoTarget(scene, place, moment.point().state.pose(), lines);
  const PlutoOutput output = networkOf(scene.world()).forward(builder.inputOf(moment, lines));
  const auto largest = static_cast<std::size_t>(
      std::max_element(output.logits.begin(), output.logits.end()) - output.logits.begin());
  std::pair<double, double> best = {1e9, 1e9};
  for (const PlutoTrajectory& candidate : output.candidates)
    best = std::min(best, distancesOf(candidate.leftCols<2>(), target));
  const PlutoOptions options;
  const PlutoChoice choice =
      choosePlan(output.logits, static_cast<std::size_t>(options.top), options.free_score);
  const bool free = choice.index == output.candidates.size();
  const auto chosen = distancesOf(output.candidates[largest].leftCols<2>(), target);
  const auto free_plan = distancesOf(output.free.leftCols<2>(), target);
  const auto note = [&](const std::string& name, const std::pair<double, double>& distances) {
    sums_[name].mean += distances.first;
    sums_[name].end += distances.second;
  };
  note("best_score", chosen);
  note("nearest", best);
  note("free", free_plan);
  note("driven", free ? free_plan : chosen);
  addBaselines(target, moment.point().state.speed);
  count_ += 1.0;
  free_ += free ? 1.0 : 0.0;
  const bool right = largest == target.line * static_cast<std::size_t>(kPlutoModes) + target.mode;
  right_ += right ? 1.0 : 0.0;
}

void PlutoValidation::addBaselines(const PlutoTarget& target, double speed) {
  for (const auto& [name, pace] :
       {std::make_pair("standing", 0.0), std::make_pair("constant_speed", speed)}) {
    const auto [mean, end] = distancesOf(atSpeed(pace), target);
    sums_[name].mean += mean;
    sums_[name].end += end;
  }
}

learning::Measures PlutoValidation::measures() const {
  learning::Measures measures;
  const double count = std::max(1.0, count_);
  for (const auto& [name, sum] : sums_) {
    measures[name + "_ade_m"] = sum.mean / count;
    measures[name + "_fde_m"] = sum.end / count;
  }
  measures["free_share"] = free_ / count;
  measures["right_mode_share"] = right_ / count;
  return measures;
}

std::string plutoTable(const learning::Measures& held_out) {
  std::string table =
      "Distance to where the vehicle was in the next 4 s: mean, and at their end [m].\n\n"
      "| Plan | mean | at the end |\n|---|---|---|\n";
  const std::pair<const char*, const char*> rows[] = {
      {"that drives (RIFT's choice)", "driven"},
      {"candidate of the largest score", "best_score"},
      {"nearest of all candidates", "nearest"},
      {"without a reference line", "free"},
      {"stands", "standing"},
      {"keeps its speed straight on", "constant_speed"}};
  for (const auto& [title, name] : rows) {
    const std::string key = name;
    table += "| " + std::string(title) + " | " + core::formatFixed(held_out.at(key + "_ade_m"), 3) +
             " | " + core::formatFixed(held_out.at(key + "_fde_m"), 3) + " |\n";
  }
  table += "\nThe plan without a reference line drives at " +
           core::formatFixed(100.0 * held_out.at("free_share"), 1) +
           " % of the moments; the largest score has the right line and mode at " +
           core::formatFixed(100.0 * held_out.at("right_mode_share"), 1) + " %.\n";
  return table;
}

}  // namespace cdiff::planners

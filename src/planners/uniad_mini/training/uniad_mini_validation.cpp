// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/uniad_mini/training/uniad_mini_validation.h"

#include <algorithm>

#include "core/text.h"
#include "planners/uniad_mini/training/uniad_losses.h"
#include "planners/uniad_mini/uniad_mini.h"
#include "planners/vad_mini/training/vad_mini_validation.h"

namespace cdiff::planners {
namespace {

constexpr double kSureLine = 0.3;

std::vector<Detection> detectionsOf(const UniadMiniOutput& output) {
  std::vector<Detection> detections;
  for (const DetectedAgent& agent : output.agents)
    detections.push_back({{agent.box[0], agent.box[1]}, logistic(agent.score)});
  return detections;
}

/// The surest agent within reach of a label; nullptr where none is a track.
const DetectedAgent* agentAt(const UniadMiniOutput& output, const AgentLabel& label) {
  const DetectedAgent* best = nullptr;
  for (const DetectedAgent& agent : output.agents) {
    const Eigen::Vector2d apart(agent.box[0] - label.box[0], agent.box[1] - label.box[1]);
    if (apart.norm() > DetectionMeasures::kReach || logistic(agent.score) < kKeepScore) continue;
    if (best == nullptr || agent.score > best->score) best = &agent;
  }
  return best;
}

void copyBev(const inference::Rows& from, std::int64_t width, inference::Rows& to) {
  to.resize(from.rows(), width);
  for (std::int64_t row = 0; row < from.rows(); ++row)
    std::copy_n(from.row(row), width, to.row(row));
}

}  // namespace

UniadMiniValidation::UniadMiniValidation(const UniadMiniModel& model,
                                         const ConstantDetections& prior)
    : architecture_(model.architecture), network_(model), prior_(prior) {}

UniadMiniOutput UniadMiniValidation::look(const EgoExample& example) {
  UniadMiniOutput output;
  inference::Rows past;
  TrackSet tracks;
  for (std::size_t i = 0; i < example.looks.size(); ++i) {
    const EgoFrame& look = example.looks[i];
    UniadMiniInput input;
    for (const traffic::CameraImage& image : look.images) input.images.push_back(image.rgb.data());
    input.motion = look.motion;
    input.poses = look.poses;
    input.past = i > 0 && architecture_.ego.past_bev ? &past : nullptr;
    input.past_tracks = i > 0 ? &tracks : nullptr;
    input.command = example.command;
    output = network_.forward(input);
    copyBev(network_.bevAlone(look.motion), architecture_.ego.width, past);
    tracks = std::move(output.tracks);
  }
  return output;
}

void UniadMiniValidation::addForecasts(const EgoExample& example, const UniadMiniOutput& output) {
  for (const AgentLabel& label : example.agents) {
    const DetectedAgent* agent = agentAt(output, label);
    if (agent == nullptr || label.future.known < label.future.places.size()) continue;
    double least = 1e9;
    for (const EgoWaypoints& way : agent->ways)
      least = std::min(least, (way.back() - label.future.places.back()).norm());
    end_sum_ += least;
    end_count_ += 1.0;
  }
}

/// At the second waypoint, 1 s ahead.
void UniadMiniValidation::addOccupancy(const EgoExample& example, const UniadMiniOutput& output) {
  constexpr std::size_t kStep = 2;
  const std::vector<float> seen = output.occupancy.probability(kStep);
  std::vector<float> wanted(seen.size(), 0.0F);
  for (const AgentLabel& label : example.agents) {
    if (label.future.known < kStep) continue;
    const std::vector<float> mask = maskOf(architecture_.ego.bev, futureBox(label, kStep - 1));
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = std::max(wanted[i], mask[i]);
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const bool occupied = seen[i] >= 0.5F, expected = wanted[i] > 0.5F;
    meet_ += occupied && expected ? 1.0 : 0.0;
    join_ += occupied || expected ? 1.0 : 0.0;
  }
}

void UniadMiniValidation::add(const EgoExample& example) {
  const UniadMiniOutput output = look(example);
  const PlanAdjustmentOptions adjustment;
  const BevGrid& bev = architecture_.ego.bev;
  ego_.add(example,
           {output.plan, detectionsOf(output), sureLines({{}, output.lines, {}}, kSureLine)},
           prior_, bev);
  adjusted_.add(
      example, adjustedPlan(output.plan, occupiedPlaces(bev, output.occupancy, adjustment.occupied),
                            adjustment));
  addForecasts(example, output);
  addOccupancy(example, output);
}

learning::Measures UniadMiniValidation::measures() const {
  learning::Measures measures = ego_.measures();
  adjusted_.report(measures);
  measures["forecast_min_fde_m"] = end_count_ > 0.0 ? end_sum_ / end_count_ : 0.0;
  measures["occupancy_iou_1s_percent"] = join_ > 0.0 ? 100.0 * meet_ / join_ : 0.0;
  return measures;
}

std::string uniadTable(const learning::Measures& held_out) {
  const auto number = [&](const std::string& key) {
    return core::formatFixed(held_out.at(key), 2);
  };
  const auto three = [&](const std::string& begin, const std::string& end) {
    return number(begin + "1s_" + end) + " / " + number(begin + "2s_" + end) + " / " +
           number(begin + "3s_" + end);
  };
  return egoTable(held_out, "UniAD mini") + "\nAdjusted by occupancy: L2 " +
         three("adjusted_l2_at_", "m") + " m, collisions " +
         three("adjusted_collisions_at_", "percent") +
         " % (at). Forecasts of vehicles that were seen: best of six modes " +
         number("forecast_min_fde_m") +
         " m away at 3 s. Occupancy 1 s ahead: " + number("occupancy_iou_1s_percent") +
         " % intersection over union.\n";
}

}  // namespace cdiff::planners

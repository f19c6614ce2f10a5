// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_validation.h"

#include <algorithm>

namespace cdiff::planners {
namespace {

constexpr double kSureLine = 0.3;

std::vector<Detection> detectionsOf(const VadMiniOutput& output) {
  std::vector<Detection> detections;
  for (const DetectedAgent& agent : output.agents)
    detections.push_back({{agent.box[0], agent.box[1]}, logistic(agent.score)});
  return detections;
}

}  // namespace

std::vector<BevLine> sureLines(const VadMiniOutput& output, double least) {
  std::vector<BevLine> lines;
  for (const DetectedLine& seen : output.lines) {
    const auto best = std::max_element(seen.scores.begin(), seen.scores.end());
    if (logistic(*best) < least) continue;
    lines.push_back({static_cast<MapKind>(best - seen.scores.begin()), seen.points});
  }
  return lines;
}

VadMiniValidation::VadMiniValidation(const VadMiniModel& model, const ConstantDetections& prior)
    : architecture_(model.architecture), network_(model), prior_(prior) {}

VadMiniOutput VadMiniValidation::look(const EgoExample& example) {
  VadMiniOutput output;
  inference::Rows past;
  for (std::size_t i = 0; i < example.looks.size(); ++i) {
    const EgoFrame& look = example.looks[i];
    VadMiniInput input;
    for (const traffic::CameraImage& image : look.images) input.images.push_back(image.rgb.data());
    input.motion = look.motion;
    input.poses = look.poses;
    input.past = i > 0 ? &past : nullptr;
    output = network_.forward(input);
    const inference::Rows& bev = network_.bevAlone(look.motion);
    past.resize(bev.rows(), architecture_.ego.width);
    for (std::int64_t row = 0; row < bev.rows(); ++row)
      std::copy_n(bev.row(row), architecture_.ego.width, past.row(row));
  }
  return output;
}

void VadMiniValidation::add(const EgoExample& example) {
  const VadMiniOutput output = look(example);
  ego_.add(example,
           {output.plans[static_cast<std::size_t>(example.command)], detectionsOf(output),
            sureLines(output, kSureLine)},
           prior_, architecture_.ego.bev);
}

}  // namespace cdiff::planners

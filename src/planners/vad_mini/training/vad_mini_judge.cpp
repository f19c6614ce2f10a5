// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/vad_mini/training/vad_mini_judge.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace cdiff::planners {
namespace {

constexpr double kSureLine = 0.3;

std::vector<Detection> detectionsOf(const VadMiniOutput& output) {
  std::vector<Detection> detections;
  for (const SeenAgent& agent : output.agents)
    detections.push_back({{agent.box[0], agent.box[1]}, logistic(agent.score)});
  return detections;
}

}  // namespace

std::vector<BevLine> sureLines(const VadMiniOutput& output, double least) {
  std::vector<BevLine> lines;
  for (const SeenLine& seen : output.lines) {
    const auto best = std::max_element(seen.scores.begin(), seen.scores.end());
    if (logistic(*best) < least) continue;
    lines.push_back({static_cast<MapKind>(best - seen.scores.begin()), seen.points});
  }
  return lines;
}

VadMiniJudge::VadMiniJudge(const VadMiniModel& model, const ConstantDetections& prior)
    : architecture_(model.architecture), network_(model), prior_(prior) {}

VadMiniOutput VadMiniJudge::look(const EgoExample& example) {
  VadMiniOutput output;
  inference::Rows past;
  for (std::size_t i = 0; i < example.looks.size(); ++i) {
    const EgoLook& look = example.looks[i];
    VadMiniInput input;
    for (const traffic::CameraImage& image : look.images) input.images.push_back(image.rgb.data());
    input.motion = look.motion;
    input.poses = look.poses;
    input.past = i > 0 ? &past : nullptr;
    output = network_.forward(input);
    const inference::Rows& bev = network_.bev();
    past.resize(bev.rows(), architecture_.ego.width);
    for (std::int64_t row = 0; row < bev.rows(); ++row)
      std::copy_n(bev.row(row), architecture_.ego.width, past.row(row));
  }
  return output;
}

void VadMiniJudge::add(const EgoExample& example) {
  const VadMiniOutput output = look(example);
  plan_.add(example, output.plans[static_cast<std::size_t>(example.command)]);
  constant_.add(example, atConstantVelocity(example.speed));
  detection_.add(example, detectionsOf(output));
  prior_detection_.add(example, prior_.detections());
  map_.add(sureLines(output, kSureLine), example.lines);
  straight_.add(straightRoad(architecture_.ego.bev), example.lines);
}

learning::Measures VadMiniJudge::measures() const {
  learning::Measures measures;
  plan_.report(measures);
  constant_.report(measures);
  measures["detection_ap_2m_percent"] = 100.0 * detection_.averagePrecision();
  measures["constant_detection_ap_2m_percent"] = 100.0 * prior_detection_.averagePrecision();
  measures["map_chamfer_m"] = map_.chamfer();
  measures["straight_map_chamfer_m"] = straight_.chamfer();
  return measures;
}

std::string egoTable(const learning::Measures& held_out, const std::string& title) {
  const auto number = [&](const std::string& key, int decimals) {
    return core::formatFixed(held_out.at(key), decimals);
  };
  std::string table =
      "Distance to where the ego was driven [m] and moments with a collision [%] at 1, 2 and 3 s; "
      "at: at that time; to: mean up to it.\n\n"
      "| Plan | L2 at | L2 to | collisions at | collisions to |\n|---|---|---|---|---|\n";
  for (const auto& [name, prefix] :
       {std::make_pair(title, std::string()),
        std::make_pair(std::string("keeps its velocity"), std::string("constant_velocity_"))}) {
    table += "| " + name + " |";
    for (const char* kind : {"l2_at_", "l2_to_", "collisions_at_", "collisions_to_"}) {
      const bool l2 = kind[0] == 'l';
      for (const char* second : {"1s", "2s", "3s"})
        table += (second[0] == '1' ? " " : " / ") +
                 number(prefix + kind + second + (l2 ? "_m" : "_percent"), 2);
      table += " |";
    }
    table += "\n";
  }
  return table + "\nDetection (average precision at 2 m): " + number("detection_ap_2m_percent", 1) +
         " %; the same boxes at every moment: " + number("constant_detection_ap_2m_percent", 1) +
         " %. Map (Chamfer distance): " + number("map_chamfer_m", 2) +
         " m; a straight road: " + number("straight_map_chamfer_m", 2) + " m.\n";
}

}  // namespace cdiff::planners

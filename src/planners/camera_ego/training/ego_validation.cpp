// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/ego_validation.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/random.h"
#include "metrics/formulas/quantiles.h"

namespace cdiff::planners {
namespace {

/// A measure, and that of what it must beat.
struct Compared {
  std::string name;
  std::string baseline;
  double better = -1.0;  ///< -1: less is better, 1: more
};

std::vector<Compared> comparedMeasures() {
  std::vector<Compared> all = {{"detection_ap_2m_percent", "constant_detection_ap_2m_percent", 1.0},
                               {"map_chamfer_m", "straight_map_chamfer_m", -1.0}};
  for (const std::string second : {"1s", "2s", "3s"}) {
    for (const std::string convention : {"at_", "to_"}) {
      for (const std::string& name :
           {"l2_" + convention + second + "_m", "collisions_" + convention + second + "_percent"})
        all.push_back({name, "constant_velocity_" + name, -1.0});
    }
  }
  return all;
}

void addGains(learning::Measures& measures) {
  for (const Compared& compared : comparedMeasures()) {
    measures[compared.name + "_gain"] =
        compared.better * (measures.at(compared.name) - measures.at(compared.baseline)) +
        0.0;  // no -0
  }
}

}  // namespace

void EgoMeasures::add(const EgoExample& example, const EgoAnswer& answer,
                      const ConstantDetections& prior, const BevGrid& bev) {
  moments_ += 1.0;
  plan_.add(example, answer.plan);
  constant_.add(example, atConstantVelocity(example.speed));
  detection_.add(example, answer.detections);
  prior_detection_.add(example, prior.detections());
  map_.add(answer.lines, example.lines);
  straight_.add(straightRoad(bev), example.lines);
}

void EgoMeasures::merge(const EgoMeasures& other) {
  moments_ += other.moments_;
  plan_.merge(other.plan_);
  constant_.merge(other.constant_);
  detection_.merge(other.detection_);
  prior_detection_.merge(other.prior_detection_);
  map_.merge(other.map_);
  straight_.merge(other.straight_);
}

void EgoMeasures::report(learning::Measures& measures) const {
  plan_.report(measures);
  constant_.report(measures);
  measures["detection_ap_2m_percent"] = 100.0 * detection_.averagePrecision();
  measures["constant_detection_ap_2m_percent"] = 100.0 * prior_detection_.averagePrecision();
  measures["map_chamfer_m"] = map_.chamfer();
  measures["straight_map_chamfer_m"] = straight_.chamfer();
}

std::string EgoValidation::byNetwork() const {
  std::string rows = "network,moments,measure,value\n";
  int number = 0;
  for (const auto& [name, part] : by_network_) {
    learning::Measures measures;
    part.report(measures);
    const std::string begin =
        std::to_string(++number) + "," + core::formatNumber(part.moments()) + ",";
    for (const auto& [measure, value] : measures)
      rows += begin + measure + "," + core::formatNumber(value) + "\n";
  }
  return rows;
}

learning::Measures EgoValidation::measures() const {
  std::vector<const EgoMeasures*> networks;
  EgoMeasures all;
  for (const auto& [name, part] : by_network_) {
    networks.push_back(&part);
    all.merge(part);
  }
  learning::Measures measures;
  all.report(measures);
  addGains(measures);
  if (networks.size() < 3) return measures;
  const core::RandomStream draws(0, "held-out networks");
  std::map<std::string, std::vector<double>> replicates;
  for (std::uint32_t replicate = 0; replicate < kReplicates; ++replicate) {
    EgoMeasures drawn;
    for (std::uint32_t i = 0; i < networks.size(); ++i)
      drawn.merge(*networks[draws.index({replicate}, i, networks.size())]);
    learning::Measures of_drawn;
    drawn.report(of_drawn);
    addGains(of_drawn);
    for (const auto& [name, value] : of_drawn) replicates[name].push_back(value);
  }
  constexpr auto kRule = metrics::QuantileRule::kNearestToLinear;
  const double tail = metrics::expandedTail(networks.size());
  for (auto& [name, values] : replicates) {
    std::sort(values.begin(), values.end());
    measures[name + "_low"] = metrics::quantileOf(values, tail, kRule);
    measures[name + "_high"] = metrics::quantileOf(values, 1.0 - tail, kRule);
  }
  return measures;
}

namespace {

/// "VALUE [LOW, HIGH]", or the value alone.
std::string withInterval(const learning::Measures& measures, const std::string& name,
                         int decimals) {
  const auto low = measures.find(name + "_low");
  const std::string value = core::formatFixed(measures.at(name), decimals);
  if (low == measures.end()) return value;
  return value + " [" + core::formatFixed(low->second, decimals) + ", " +
         core::formatFixed(measures.at(name + "_high"), decimals) + "]";
}

/// A row of the table of plans; `prefix` and `suffix` name its measures.
std::string planRow(const learning::Measures& measures, const std::string& title,
                    const std::string& prefix, const std::string& suffix) {
  std::string row = "| " + title + " |";
  for (const std::string kind : {"l2_at_", "l2_to_", "collisions_at_", "collisions_to_"}) {
    const std::string unit = kind[0] == 'l' ? "_m" : "_percent";
    for (const std::string second : {"1s", "2s", "3s"}) {
      row += (second == "1s" ? " " : " / ") +
             withInterval(measures, prefix + kind + second + unit + suffix, 2);
    }
    row += " |";
  }
  return row + "\n";
}

}  // namespace

std::string egoTable(const learning::Measures& held_out, const std::string& title) {
  std::string table =
      "Distance to where the ego was driven [m] and moments with a collision [%] at 1, 2 and 3 s; "
      "at: at that time; to: mean up to it. Brackets: 95 %, bootstrap by held-out networks.\n\n"
      "| Plan | L2 at | L2 to | collisions at | collisions to |\n|---|---|---|---|---|\n";
  table += planRow(held_out, title, "", "");
  table += planRow(held_out, "keeps its velocity", "constant_velocity_", "");
  if (held_out.count("l2_at_1s_m_gain") > 0)
    table += planRow(held_out, "by how much the first is better, paired", "", "_gain");
  table += "\nDetection (average precision at 2 m): " +
           withInterval(held_out, "detection_ap_2m_percent", 1) +
           " %; the same boxes at every moment: " +
           withInterval(held_out, "constant_detection_ap_2m_percent", 1) +
           " %. Map (Chamfer distance): " + withInterval(held_out, "map_chamfer_m", 2) +
           " m; a straight road: " + withInterval(held_out, "straight_map_chamfer_m", 2) + " m";
  if (held_out.count("map_chamfer_m_gain") > 0)
    table += ", " + withInterval(held_out, "map_chamfer_m_gain", 2) + " m more";
  return table + ".\n";
}

}  // namespace cdiff::planners

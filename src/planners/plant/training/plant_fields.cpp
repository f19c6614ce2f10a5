// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/training/plant_samples.h"

namespace cdiff::planners {
namespace {

using learning::FieldSpec;
using learning::FieldType;
using Floats = std::vector<float>;

Floats flatTokens(const std::vector<PlantToken>& tokens) {
  Floats values;
  for (const PlantToken& token : tokens) values.insert(values.end(), token.begin(), token.end());
  return values;
}

std::vector<PlantToken> tokensOf(const Floats& values) {
  std::vector<PlantToken> tokens(values.size() / kPlantAttributes);
  for (std::size_t i = 0; i < values.size(); ++i)
    tokens.at(i / kPlantAttributes)[i % kPlantAttributes] = values[i];
  return tokens;
}

}  // namespace

learning::SampleSchema plantFields() {
  const std::int64_t any = learning::kAnyCount;
  return {{{learning::kSessionField, FieldType::kU64},
           {"vehicles", FieldType::kF32, {any, kPlantAttributes}},
           {"next", FieldType::kU8, {any, kPlantAttributes}},
           {"route", FieldType::kF32, {any, kPlantAttributes}},
           {"red_light", FieldType::kU8},
           {"target", FieldType::kF32, {2}},
           {"waypoints", FieldType::kF32, {kPlantWaypoints, 2}},
           {"speed", FieldType::kF32}}};
}

learning::Sample toSample(const PlantExample& example) {
  Floats waypoints;
  for (const Eigen::Vector2d& place : example.driven) {
    waypoints.push_back(static_cast<float>(place.x()));
    waypoints.push_back(static_cast<float>(place.y()));
  }
  std::vector<std::uint8_t> next;
  for (const auto& bins : example.next) next.insert(next.end(), bins.begin(), bins.end());
  const PlantInput& input = example.input;
  return {{{learning::kSessionField, std::vector<std::uint64_t>{example.session}},
           {"vehicles", flatTokens(input.vehicles)},
           {"next", next},
           {"route", flatTokens(input.route)},
           {"red_light",
            std::vector<std::uint8_t>{input.red_light ? std::uint8_t{1} : std::uint8_t{0}}},
           {"target", Floats(input.target.begin(), input.target.end())},
           {"waypoints", waypoints},
           {"speed", Floats{static_cast<float>(example.speed)}}}};
}

PlantExample toExample(const learning::Sample& sample) {
  PlantExample example;
  example.session = sample.get<std::vector<std::uint64_t>>(learning::kSessionField).at(0);
  example.input.vehicles = tokensOf(sample.get<Floats>("vehicles"));
  example.input.route = tokensOf(sample.get<Floats>("route"));
  example.input.red_light = sample.get<std::vector<std::uint8_t>>("red_light").at(0) != 0;
  const auto& target = sample.get<Floats>("target");
  example.input.target = {target.at(0), target.at(1)};
  const auto& waypoints = sample.get<Floats>("waypoints");
  for (std::size_t i = 0; i < example.driven.size(); ++i)
    example.driven[i] = {waypoints.at(2 * i), waypoints.at(2 * i + 1)};
  const auto& next = sample.get<std::vector<std::uint8_t>>("next");
  example.next.resize(next.size() / kPlantAttributes);
  for (std::size_t i = 0; i < next.size(); ++i)
    example.next.at(i / kPlantAttributes)[i % kPlantAttributes] = next[i];
  example.speed = static_cast<double>(sample.get<Floats>("speed").at(0));
  return example;
}

}  // namespace cdiff::planners

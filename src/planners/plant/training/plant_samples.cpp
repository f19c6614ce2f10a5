// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/plant/training/plant_samples.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/file.h"
#include "e2e_cdiff/core/random.h"
#include "learning/samples/sample_order.h"
#include "planning/route_follower.h"

namespace cdiff::planners {
namespace {

using learning::Scene;

constexpr std::size_t kStepsPerWaypoint = 5;  // decisions
constexpr std::size_t kHorizon = kStepsPerWaypoint * kPlantWaypoints;

std::uint8_t binOf(double value, double low, double high, std::int64_t bins) {
  const double place = (value - low) / (high - low) * static_cast<double>(bins);
  return static_cast<std::uint8_t>(
      std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(place)), 0, bins - 1));
}

/// Where a drive's vehicle is at a decision.
struct DrivePlace {
  const traffic::Vehicle* vehicle = nullptr;
  double arc_length = 0.0;
};

/// Follows the drives of one scene and makes its examples.
class SceneExamples {
 public:
  SceneExamples(const Scene& scene, const map::RoadNetwork& network,
                const PlantArchitecture& architecture, const learning::SceneSampleOptions& options)
      : scene_(scene),
        architecture_(architecture),
        options_(options),
        thinning_(core::hashText(scene.name), "plant_standing"),
        places_(scene.drives.size()) {
    for (const learning::SceneDrive& drive : scene.drives)
      routes_.push_back(learning::routeOf(scene, drive, network));
    for (const auto& [tick, contact] : scene.contacts) {
      contacts_.insert({contact.first, tick});
      contacts_.insert({contact.second, tick});
    }
    followAll();
  }

  std::vector<PlantExample> make() const {
    std::vector<PlantExample> examples;
    for (std::size_t i = 0; i + kHorizon < scene_.decisions.size(); ++i) {
      for (const auto& [slot, drive] : scene_.driven[i]) {
        if (!options_.wants(scene_.drives[drive].driver.target_speed)) continue;
        const bool due = (i + static_cast<std::size_t>(slot + 1)) % options_.stride() == 0;
        if (due && fit(i, drive) && !thinned(i, drive)) examples.push_back(exampleAt(i, drive));
      }
    }
    return examples;
  }

 private:
  /// Along each route, decision by decision, as a planner follows it.
  void followAll() {
    std::vector<planning::RouteFollower> followers(scene_.drives.size());
    for (std::size_t i = 0; i < scene_.decisions.size(); ++i) {
      for (const auto& [slot, drive] : scene_.driven[i]) {
        const traffic::Vehicle* vehicle = scene_.decisions[i].find(scene_.drives[drive].vehicle_id);
        if (vehicle == nullptr) continue;
        followers[drive].update(routes_[drive], vehicle->state.position);
        places_[drive][i] = {vehicle, followers[drive].arcLength()};
      }
    }
  }

  const DrivePlace* placeAt(std::size_t i, std::size_t drive) const {
    const auto found = places_[drive].find(i);
    return found == places_[drive].end() ? nullptr : &found->second;
  }

  /// Whether the vehicle drives by itself from a decision to the end of the horizon.
  bool fit(std::size_t begin, std::size_t drive) const {
    const std::string& id = scene_.drives[drive].vehicle_id;
    const traffic::Vehicle* before = nullptr;
    for (std::size_t i = begin; i <= begin + kHorizon; ++i) {
      const std::uint64_t tick = scene_.decisions[i].tick;
      const DrivePlace* place = placeAt(i, drive);
      if (place == nullptr || !place->vehicle->applied_action) return false;
      if (i < begin + kHorizon && scene_.disturbed.count({id, tick}) != 0) return false;
      if (before != nullptr && !learning::drivesOn(before->state, place->vehicle->state))
        return false;
      before = place->vehicle;
    }
    const auto contact = contacts_.lower_bound({id, scene_.decisions[begin].tick});
    return contact == contacts_.end() || contact->first != id ||
           contact->second > scene_.decisions[begin + kHorizon].tick;
  }

  bool thinned(std::size_t begin, std::size_t drive) const {
    for (std::size_t i = begin; i <= begin + kHorizon; ++i) {
      if (placeAt(i, drive)->vehicle->state.speed > learning::kStanding) return false;
    }
    const core::RandomKey key{core::hashText(scene_.drives[drive].vehicle_id),
                              static_cast<std::uint32_t>(begin), 0};
    return thinning_.uniform(key, 0) >= options_.standing_share;
  }

  PlantExample exampleAt(std::size_t begin, std::size_t drive) const {
    const traffic::TrafficSnapshot& snapshot = scene_.decisions[begin];
    const DrivePlace& place = *placeAt(begin, drive);
    const geometry::Pose2d pose = place.vehicle->state.pose();
    PlantExample example;
    example.input =
        plantInput(architecture_, snapshot, *place.vehicle, routes_[drive], place.arc_length);
    example.speed = place.vehicle->state.speed;
    example.session = core::hashText(scene_.name);
    for (std::size_t n = 0; n < example.driven.size(); ++n) {
      const std::size_t later = begin + (n + 1) * kStepsPerWaypoint;
      example.driven[n] = pose.toBody(placeAt(later, drive)->vehicle->state.position);
    }
    const traffic::TrafficSnapshot& next = scene_.decisions[begin + kStepsPerWaypoint];
    for (const std::string& id : example.input.ids) {
      const traffic::Vehicle* other = next.find(id);
      example.next.emplace_back();
      example.next.back().fill(kNoBin);
      if (other != nullptr)
        example.next.back() = plantBins(plantToken(pose, other->state, other->dimensions));
    }
    example.input.ids.clear();
    return example;
  }

  const Scene& scene_;
  const PlantArchitecture& architecture_;
  const learning::SceneSampleOptions& options_;
  core::RandomStream thinning_;
  std::vector<map::Route> routes_;                            ///< by drive
  std::vector<std::map<std::size_t, DrivePlace>> places_;     ///< by drive, then decision
  std::set<std::pair<std::string, std::uint64_t>> contacts_;  ///< vehicle, tick
};

}  // namespace

std::array<std::uint8_t, kPlantAttributes> plantBins(const PlantToken& token) {
  constexpr double kRange = 30.0;          // of x and y to either side, and of extents [m]
  constexpr double kFastest = 60.0 / 3.6;  // [m/s]
  const auto value = [&](std::size_t i, double scale) {
    return scale * static_cast<double>(token[i]);
  };
  return {binOf(value(0, kPlantPlaceScale), -kRange, kRange, kPlantBins[0]),
          binOf(value(1, kPlantPlaceScale), -kRange, kRange, kPlantBins[1]),
          binOf(value(2, 1.0), -1.0, 1.0, kPlantBins[2]),
          binOf(value(3, kPlantSpeedScale), 0.0, kFastest, kPlantBins[3]),
          binOf(value(4, kPlantExtentScale), 0.0, kRange, kPlantBins[4]),
          binOf(value(5, kPlantExtentScale), 0.0, kRange, kPlantBins[5])};
}

const map::RoadNetwork& PlantSampler::networkOf(const learning::Scene& scene) {
  auto& network = networks_[core::sha256(scene.network_text)];
  if (!network) {
    network = std::make_unique<map::RoadNetwork>(
        map::RoadNetwork::fromText(scene.network_text, scene.network_source));
  }
  return *network;
}

std::vector<PlantExample> PlantSampler::examplesOf(const learning::Scene& scene) {
  learning::requireScenePeriod(scene, "PlanT learns");
  return SceneExamples(scene, networkOf(scene), architecture_, options_).make();
}

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

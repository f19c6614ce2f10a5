// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/training/ego_data.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "learning/samples/sample_order.h"

namespace cdiff::planners {
namespace {

// Elements of the draws of a sample.
constexpr std::uint32_t kDisplacedDraw = 0;
constexpr std::uint32_t kBesideDraw = 1;
constexpr std::uint32_t kTurnedDraw = 2;
// Of a step.
constexpr std::uint32_t kLooksDraw = 3;
constexpr std::size_t kSecondOfDecisions = 10;

/// What a vehicle does within a second.
const char* paceOf(double now, double then) {
  const bool stands = now < learning::kStanding, will_stand = then < learning::kStanding;
  if (stands && will_stand) return "standing";
  if (stands) return "starting";
  if (then < now - 1.5) return "braking";
  if (now < 4.0) return "slow";
  return now < 8.0 ? "middle" : "fast";
}

}  // namespace

void EgoSampleOptions::describe(core::OptionsVisitor& visitor) {
  PlutoSampleOptions::describe(visitor);
  visitor.number({"balance", "", "Weight n^-balance of a class of n moments."}, balance, 0.0, 1.0);
  visitor.number({"displaced_share", "", "Part of the moments seen from beside the true place."},
                 displaced_share, 0.0, 1.0);
  visitor.number({"displacement", "m", "To either side, at most."}, displacement, 0.0, 2.0);
  visitor.number({"displaced_turn", "rad", "To either side, at most."}, displaced_turn, 0.0, 0.5);
  visitor.integer({"past_looks", "", "Most looks before the present one."}, past_looks, 1, 4);
  visitor.flag({"blind", "", "Whether images are mid-gray, to see what images are worth."}, blind);
}

std::vector<learning::Sample> EgoData::samplesOf(const learning::Scene& scene,
                                                 const EgoSampleOptions& options) {
  if (!worlds_) worlds_.emplace(PlutoArchitecture());
  const auto number = static_cast<std::uint32_t>(scenes_.size());
  scenes_.emplace_back(scene, worlds_->of(scene));
  std::vector<learning::Sample> samples;
  for (const PlutoPlace& place : plutoPlaces(scenes_.back(), number, options))
    samples.push_back(toSample(place, scenes_.back()));
  return samples;
}

void EgoData::start(const learning::TrainingRun& run, const EgoSampleOptions& options,
                    const rendering::CameraRig& rig, const BevGrid& bev,
                    const EgoExampleOptions& labels) {
  run_ = &run;
  options_ = &options;
  labels_ = labels;
  rendering::CameraRig cameras = rig;
  cameras.blind = options.blind;
  examples_ = std::make_unique<EgoExamples>(cameras, bev);
  places_.clear();
  for (std::size_t i = 0; i < run.dataset.size(); ++i)
    places_.push_back(toPlutoPlace(run.dataset.sample(i)));
}

std::string EgoData::classOf(const PlutoPlace& place) const {
  const PlutoScene& scene = scenes_[place.scene];
  const std::uint32_t vehicle = scene.drives()[place.drive].vehicle;
  const auto speedAt = [&](std::size_t decision) {
    const std::size_t last = scene.frames().size() - 1;
    const TrackPoint* point = scene.frames()[std::min(decision, last)].find(vehicle);
    return point == nullptr ? 0.0 : point->state.speed;
  };
  return std::string(toText(examples_->commandAt(scene, place))) + " " +
         paceOf(speedAt(place.decision), speedAt(place.decision + kSecondOfDecisions));
}

std::vector<double> EgoData::weights() const {
  std::vector<std::string> classes;
  std::map<std::string, double> counts;
  for (const std::size_t index : run_->dataset.training()) {
    classes.push_back(classOf(places_[index]));
    counts[classes.back()] += 1.0;
  }
  double largest = 0.0;
  for (const auto& [name, count] : counts) largest = std::max(largest, count);
  std::vector<double> weights;
  double sum = 0.0;
  for (const std::string& name : classes) {
    const double weight = std::pow(largest / counts.at(name), options_->balance);
    weights.push_back(std::min(learning::kMostWeight, weight));
    sum += weights.back();
  }
  for (double& weight : weights) weight *= static_cast<double>(weights.size()) / sum;
  return weights;
}

std::vector<EgoExample> EgoData::examplesOf(const std::vector<std::size_t>& samples,
                                            std::int64_t step, const core::RandomStream& random,
                                            std::size_t looks) {
  std::vector<EgoExample> examples;
  EgoExampleOptions options = labels_;
  const auto number = static_cast<std::uint32_t>(step);
  const auto most = static_cast<std::size_t>(options_->past_looks);
  options.looks = std::min(looks, 2 + random.index({0, number, 0}, kLooksDraw, most));
  for (std::size_t row = 0; row < samples.size(); ++row) {
    const core::RandomKey key{row + 1, number, 0};
    const bool displaced = random.uniform(key, kDisplacedDraw) < options_->displaced_share;
    const auto draw = [&](std::uint32_t element, double most_of_it) {
      return displaced ? random.uniform(key, element, -most_of_it, most_of_it) : 0.0;
    };
    options.beside = draw(kBesideDraw, options_->displacement);
    options.turned = draw(kTurnedDraw, options_->displaced_turn);
    const PlutoPlace& place = places_[samples[row]];
    examples.push_back(examples_->make(scenes_[place.scene], place, options));
  }
  return examples;
}

EgoExample EgoData::exampleOf(std::size_t sample, std::size_t looks) {
  EgoExampleOptions options = labels_;
  options.looks = looks;
  const PlutoPlace& place = places_[sample];
  EgoExample example = examples_->make(scenes_[place.scene], place, options);
  example.network =
      run_->dataset.sample(sample).get<std::vector<std::uint64_t>>(learning::kSessionField).at(0);
  return example;
}

std::vector<std::vector<Eigen::Vector2d>> EgoData::agentCenters(std::size_t most) {
  const std::vector<std::size_t>& training = run_->dataset.training();
  std::vector<std::vector<Eigen::Vector2d>> centers;
  const std::size_t stride = std::max<std::size_t>(1, training.size() / most);
  for (std::size_t i = 0; i < training.size(); i += stride) {
    centers.emplace_back();
    for (const AgentLabel& label : exampleOf(training[i], 1).agents)
      centers.back().emplace_back(label.box[0], label.box[1]);
  }
  return centers;
}

}  // namespace cdiff::planners

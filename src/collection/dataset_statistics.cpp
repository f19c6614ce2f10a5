// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/dataset_statistics.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/json_file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "learning/samples/sample_order.h"
#include "page/training_pages.h"
#include "planners/pdm_lite/route_rules.h"

namespace cdiff::collection {
namespace {

namespace fs = std::filesystem;
using learning::kMoving;
using learning::kStanding;
using nlohmann::json;
using page::CountRow;

void addUp(std::map<std::string, std::uint64_t>& to,
           const std::map<std::string, std::uint64_t>& from) {
  for (const auto& [key, count] : from) to[key] += count;
}

constexpr std::size_t kSamplesAKind = 6;

std::string percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  return core::formatFixed(100.0 * static_cast<double>(part) / static_cast<double>(whole), 1);
}

void addRows(std::vector<CountRow>& rows, const std::string& kind,
             const std::map<std::string, std::uint64_t>& counts, std::uint64_t whole) {
  for (const auto& [name, count] : counts)
    rows.push_back({kind + name, std::to_string(count), percent(count, whole)});
}

std::vector<CountRow> rowsOf(const DatasetStatistics& statistics) {
  const std::uint64_t samples = statistics.samples;
  std::vector<CountRow> rows = {{"images", std::to_string(statistics.images), ""}};
  addRows(rows, "dropped: ", statistics.dropped, statistics.images);
  rows.push_back({"samples", std::to_string(samples), percent(samples, statistics.images)});
  addRows(rows, "maneuver: ", statistics.maneuvers, samples);
  addRows(rows, "stop reason: ", statistics.stop_reasons, samples);
  addRows(rows, "", statistics.kinds, samples);
  for (std::size_t i = 0; i < statistics.speeds.size(); ++i) {
    const bool last = i + 1 == statistics.speeds.size();
    const std::string range = last ? " and more" : " to " + std::to_string(2 * i + 2);
    rows.push_back({"speed " + std::to_string(2 * i) + range + " m/s",
                    std::to_string(statistics.speeds[i]), percent(statistics.speeds[i], samples)});
  }
  const auto divisor = static_cast<double>(std::max<std::uint64_t>(1, samples));
  rows.push_back(
      {"mean of absolute steer", core::formatFixed(statistics.steer_sum / divisor, 4), ""});
  rows.push_back({"contacts of driven vehicles", std::to_string(statistics.contacts), ""});
  rows.push_back({"simulated seconds", core::formatFixed(statistics.seconds, 0), ""});
  return rows;
}

/// "12 images, left out: session_end 12", and what helps where most lie too near the end.
std::string lossText(const DatasetStatistics& statistics, const std::string& remedy) {
  std::string text = std::to_string(statistics.images) + " images";
  std::string main_reason;
  std::uint64_t most = 0;
  for (const auto& [reason, count] : statistics.dropped) {
    text += (most == 0 ? ", left out: " : ", ") + reason + " " + std::to_string(count);
    if (count > most) main_reason = reason;
    most = std::max(most, count);
  }
  if (!main_reason.empty() && main_reason != "session_end") return text;
  const double horizon =
      traffic::kRolloutStep * static_cast<double>(diffusion::Architecture{}.horizon);
  return text + "; a sample needs " + core::formatNumber(horizon) +
         " s of driving after its image, so " + remedy + " are needed";
}

constexpr double kTurn = core::degreesToRadians(15.0);  // of heading over the horizon [rad]

constexpr const char* kStopReasons[] = {"none", "light", "leader", "yielding", "other"};
static_assert(std::size(kStopReasons) == learning::kStopOther + 1);

std::uint8_t maneuverOf(const learning::DrivingSample& sample, bool standing) {
  const double turned = sample.rollout(sample.rollout.rows() - 1, traffic::kRolloutHeading);
  if (standing) return 3;
  if (turned > kTurn) return 1;
  return turned < -kTurn ? 2 : 0;
}

/// For a sample whose vehicle stops or stands still.
std::uint8_t stopReasonOf(const SampleSurroundings& around, const std::string& id) {
  constexpr double kLightDistance = 40.0;     // [m]
  constexpr double kLeaderDistance = 25.0;    // [m]
  constexpr double kJunctionDistance = 25.0;  // [m]
  const traffic::Vehicle& self = *around.snapshot.find(id);
  for (const traffic::Vehicle& other : around.snapshot.vehicles) {
    const double distance = (other.state.position - self.state.position).norm();
    if (other.id == id || distance > kLeaderDistance || traffic::onDifferentLevels(self, other))
      continue;
    if (planners::isLeading(around.route, around.arc_length, other.state))
      return learning::kStopLeader;
  }
  const auto light = planners::distanceToRedLight(around.route, around.arc_length, around.snapshot);
  if (light && *light < kLightDistance) return learning::kStopLight;
  for (const auto& [from, to] : around.route.junctionStretches()) {
    if (to >= around.arc_length && from <= around.arc_length + kJunctionDistance)
      return learning::kStopYielding;
  }
  return learning::kStopOther;
}

}  // namespace

void DatasetStatistics::add(const DatasetStatistics& other) {
  images += other.images;
  samples += other.samples;
  addUp(dropped, other.dropped);
  addUp(maneuvers, other.maneuvers);
  addUp(stop_reasons, other.stop_reasons);
  addUp(kinds, other.kinds);
  for (std::size_t i = 0; i < speeds.size(); ++i) speeds[i] += other.speeds[i];
  steer_sum += other.steer_sum;
  contacts += other.contacts;
  seconds += other.seconds;
}

std::string toJson(const DatasetStatistics& statistics) {
  json text = {{"images", statistics.images},
               {"samples", statistics.samples},
               {"dropped", statistics.dropped},
               {"maneuvers", statistics.maneuvers},
               {"stop_reasons", statistics.stop_reasons},
               {"kinds", statistics.kinds},
               {"speeds_2_mps", statistics.speeds},
               {"steer_sum", statistics.steer_sum},
               {"contacts", statistics.contacts},
               {"seconds", statistics.seconds}};
  const auto samples = static_cast<double>(statistics.samples);
  if (statistics.samples > 0) text["mean_absolute_steer"] = statistics.steer_sum / samples;
  return text.dump(2) + "\n";
}

DatasetStatistics readStatistics(const std::filesystem::path& file) {
  try {
    const json text = core::readJson(file, "statistics");
    DatasetStatistics statistics;
    text.at("images").get_to(statistics.images);
    text.at("samples").get_to(statistics.samples);
    text.at("dropped").get_to(statistics.dropped);
    text.at("maneuvers").get_to(statistics.maneuvers);
    text.at("stop_reasons").get_to(statistics.stop_reasons);
    text.at("kinds").get_to(statistics.kinds);
    text.at("speeds_2_mps").get_to(statistics.speeds);
    text.at("steer_sum").get_to(statistics.steer_sum);
    text.at("contacts").get_to(statistics.contacts);
    text.at("seconds").get_to(statistics.seconds);
    return statistics;
  } catch (const json::exception& error) {
    throw core::InputError("'" + file.string() + "' holds no statistics of a session: " +
                           core::jsonFault(error) + "; expected what cdiff collect writes");
  }
}

DatasetStatistics sumOf(const StatisticsByName& statistics) {
  DatasetStatistics sum;
  for (const auto& item : statistics) sum.add(item.second);
  return sum;
}

void requireSamples(const StatisticsByName& statistics, const std::string& kind,
                    const std::string& remedy) {
  const DatasetStatistics sum = sumOf(statistics);
  if (sum.samples == 0)
    throw core::InputError("no " + kind + " gave a sample: " + lossText(sum, remedy));
  for (const auto& [name, of_one] : statistics) {
    if (of_one.samples == 0)
      std::cerr << kind << " " << name << " yielded no sample: " << lossText(of_one, remedy)
                << "\n";
  }
}

void describeDataset(const fs::path& folder, const DatasetStatistics& statistics) {
  core::writeOwnFile(folder / "statistics.json", toJson(statistics));
  const std::vector<CountRow> rows = rowsOf(statistics);
  std::cout << "| | number | % |\n|---|---|---|\n";
  for (const CountRow& row : rows)
    std::cout << "| " << row.name << " | " << row.number << " | " << row.share << " |\n";
  std::cout << std::flush;
  if (statistics.samples == 0) return;
  const fs::path page = folder / "samples.html";
  const std::string title = fs::weakly_canonical(folder).filename().string();
  const learning::Dataset stored(folder / "shards", 0.0);
  const learning::DrivingDataset dataset(stored);
  core::writeOwnFile(page, page::sampleSheet(title, rows, dataset, kSamplesAKind));
  std::cerr << "pictures: " << page.string() << "\n";
}

SampleKinds kindsOf(const learning::DrivingSample& sample) {
  SampleKinds kinds;
  const auto speeds = sample.rollout.col(traffic::kRolloutSpeed);
  const double last = speeds(speeds.size() - 1);
  kinds.standing = sample.speed < kStanding && speeds.maxCoeff() < kStanding;
  kinds.starting = sample.speed < kStanding && last > kMoving;
  kinds.stopping = sample.speed > kMoving && speeds.minCoeff() < kStanding;
  kinds.maneuver = maneuverOf(sample, kinds.standing);
  const bool stops = std::min(sample.speed, speeds.minCoeff()) < kStanding && !kinds.starting;
  kinds.stop_reason = stops ? learning::kStopOther : learning::kStopNone;
  return kinds;
}

SampleKinds kindsOf(const learning::DrivingSample& sample, const SampleSurroundings& around) {
  SampleKinds kinds = kindsOf(sample);
  const traffic::VehicleState& state = around.snapshot.find(sample.vehicle)->state;
  if (kinds.stop_reason != learning::kStopNone)
    kinds.stop_reason = stopReasonOf(around, sample.vehicle);
  kinds.off_road = !around.setup.drivableArea().contains(state.position, state.elevation);
  kinds.in_junction = around.route.inJunctionAt(around.arc_length);
  kinds.off_course = offCourse(around, state);
  return kinds;
}

bool offCourse(const SampleSurroundings& around, const traffic::VehicleState& state) {
  const double s = std::clamp(around.arc_length, 0.0, around.route.length());
  const double lateral = (around.route.path().positionAt(s) - state.position).norm();
  const double turned =
      std::abs(core::angleDifference(state.heading, around.route.path().headingAt(s)));
  return lateral > kOffCourse || turned > kOffTurn;
}

void count(const learning::DrivingSample& sample, const SampleKinds& kinds,
           DatasetStatistics& statistics) {
  ++statistics.maneuvers[learning::kManeuvers[kinds.maneuver]];
  ++statistics.stop_reasons[kStopReasons[kinds.stop_reason]];
  const std::pair<const char*, bool> flags[] = {
      {"standing", kinds.standing},       {"starting", kinds.starting},
      {"stopping", kinds.stopping},       {"off_road", kinds.off_road},
      {"in_junction", kinds.in_junction}, {"off_course", kinds.off_course},
      {"recovering", sample.recovering},  {"displaced", kinds.displaced},
      {"planned", kinds.planned}};
  for (const auto& [name, is] : flags) statistics.kinds[name] += is;
  const auto bin = static_cast<std::size_t>(std::max(0.0, sample.speed / 2.0));
  ++statistics.speeds[std::min(bin, statistics.speeds.size() - 1)];
  statistics.steer_sum += sample.rollout.col(traffic::kRolloutSteer).cwiseAbs().mean();
}

}  // namespace cdiff::collection

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/dataset_statistics.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::collection {
namespace {

using nlohmann::json;

void addUp(std::map<std::string, std::uint64_t>& to,
           const std::map<std::string, std::uint64_t>& from) {
  for (const auto& [key, count] : from) to[key] += count;
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
    const json text = json::parse(core::readFile(file, "statistics"));
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
    throw core::InputError("statistics '" + file.string() + "': " + error.what());
  }
}

DatasetStatistics sumOf(const StatisticsByName& statistics) {
  DatasetStatistics sum;
  for (const auto& item : statistics) sum.add(item.second);
  return sum;
}

}  // namespace cdiff::collection

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "exchange/scene_exporter.h"

#include <algorithm>
#include <utility>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "exchange/commonroad_writer.h"
#include "exchange/scene_table.h"

namespace cdiff::exchange {
namespace {

constexpr const char* kIndex = "index.csv";

const char* endingOf(ExportFormat format) {
  switch (format) {
    case ExportFormat::kOpenScenario:
      return ".xosc";
    case ExportFormat::kCommonRoad:
      return ".xml";
    case ExportFormat::kCsv:
      return ".csv";
  }
  return "";
}

std::vector<std::string> indexHead() {
  return {"file",         "scenario",         "seed",     "mode",    "method",
          "ego_planner",  "cbv_planner",      "status",   "verdict", "contact_seconds",
          "contact_with", "contact_with_cbv", "vehicles", "seconds", "trace_sha256"};
}

/// How a case was found. The time of the contact is that of the session, not of the scene.
std::string indexRow(const std::string& file, const RecordedScene& scene) {
  const SceneFacts& facts = scene.facts;
  const bool contact = facts.contact_seconds.has_value();
  return core::csvRow({file, facts.scenario, std::to_string(facts.seed), facts.mode, facts.method,
                       facts.ego_planner, facts.cbv_planner, facts.status, facts.verdict,
                       core::csvNumber(facts.contact_seconds), facts.contact_with,
                       contact ? (facts.contact_with_cbv ? "true" : "false") : "",
                       std::to_string(scene.vehicles.size()), core::formatNumber(scene.duration()),
                       facts.trace_sha256});
}

}  // namespace

ExportFormat exportFormat(const std::string& name) {
  if (name == "openscenario") return ExportFormat::kOpenScenario;
  if (name == "commonroad") return ExportFormat::kCommonRoad;
  if (name == "csv") return ExportFormat::kCsv;
  throw core::InputError("--format " + core::shortened(name) +
                         ": expected openscenario, commonroad or csv");
}

SceneExporter::SceneExporter(std::filesystem::path folder, ExportOptions options)
    : path_(std::move(folder)), options_(std::move(options)) {}

void SceneExporter::write(const std::string& name, const std::string& text) {
  if (!folder_) folder_.emplace(path_);
  folder_->write(name, text);
}

std::string SceneExporter::add(const std::filesystem::path& result, const std::string& name) {
  const RecordedScene scene = readScene(result, options_.scene);
  const std::string file = core::fileName(name) + endingOf(options_.format);
  if (!files_.insert(file).second) {
    throw core::InputError("'" + name + "' and another result would both be '" + file +
                           "'; export them into folders of their own");
  }
  if (file == kIndex) throw core::InputError("'" + name + "' is the name of the index");
  std::string report = file + ": " + std::to_string(scene.vehicles.size()) + " vehicles, " +
                       core::formatFixed(scene.duration(), 2) + " s\n";
  if (!scene.sizes_known)
    report += "  the result has no vehicles.csv: all are cars of 4.5 m x 1.8 m\n";
  const std::string text = fileText(scene, report);
  write(file, text);
  rows_[name] = indexRow(file, scene);
  return report;
}

std::string SceneExporter::fileText(const RecordedScene& scene, std::string& report) {
  if (options_.format == ExportFormat::kCsv) return sceneTable(scene);
  if (options_.format == ExportFormat::kOpenScenario)
    return openScenarioText(scene, networkFileOf(scene, report), options_.ego);
  const CommonRoadFile file = commonRoadFile(scene);
  if (file.left_out > 0) {
    report += "  left out: " + std::to_string(file.left_out) +
              " vehicles that appear after the start, which CommonRoad cannot hold\n";
  }
  return file.text;
}

std::string SceneExporter::networkFileOf(const RecordedScene& scene, std::string& report) {
  const std::string key = core::sha256(scene.import.text);
  const auto known = networks_.find(key);
  if (known != networks_.end()) return known->second;
  const std::string source = scene.import.source.filename().string();
  const std::string stem = core::fileName(source.substr(0, source.find('.')));
  const auto taken = [&](const std::string& name) {
    return std::any_of(networks_.begin(), networks_.end(),
                       [&](const auto& network) { return network.second == name; });
  };
  std::string file = stem + ".xodr";
  for (int number = 2; taken(file); ++number) file = stem + "_" + std::to_string(number) + ".xodr";
  const OpenDriveNetwork network = openDriveOf(scene.import);
  report += "  " + file + ": " + accuracyText(network) + "\n";
  write(file, network.text);
  return networks_[key] = file;
}

void SceneExporter::finish() {
  std::string text = core::csvRow(indexHead());
  for (const auto& [name, row] : rows_) text += row;
  write(kIndex, text);
}

}  // namespace cdiff::exchange

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The result files of a batch without what depends on wall-clock time, by the places that
/// docs/evaluation.md names.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"

namespace cdiff::test {

inline void dropWallClock(nlohmann::json& value) {
  for (const char* key : {"wall_seconds", "real_time_factor", "planner_latency_ms"}) {
    if (value.is_object()) value.erase(key);
  }
  for (nlohmann::json& inner : value) {
    if (inner.is_structured()) dropWallClock(inner);
  }
}

inline std::string runsWithoutWallClock(const std::string& csv) {
  const auto lines = core::splitText(csv, '\n');
  const auto head = core::csvCells(lines.front());
  std::string text;
  for (const std::string& line : lines) {
    const auto cells = core::csvCells(line);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (head[i] != "wall_seconds" && head[i] != "real_time_factor") text += cells[i] + ",";
    }
    text += "\n";
  }
  return text;
}

/// The text without everything from `begin` to the next `end`.
inline std::string without(std::string text, const std::string& begin, const std::string& end) {
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at))
    text.erase(at, text.find(end, at) - at);
  return text;
}

inline std::string withoutWallClock(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "result");
  const std::string name = file.filename().string();
  if (file.extension() == ".json") {
    nlohmann::json value = nlohmann::json::parse(text);
    dropWallClock(value);
    return value.dump();
  }
  if (name == "runs.csv") return runsWithoutWallClock(text);
  if (name == "junit.xml") return std::regex_replace(text, std::regex(" time=\"[^\"]*\""), "");
  if (name == "index.html") return without(text, "<section class=\"wall-clock\"", "</section>");
  if (name == "report.html") {
    const std::string latency = without(text, "<h2>Planner latency</h2>", "</section>");
    return std::regex_replace(latency, std::regex("[0-9.]+ times real time"), "");
  }
  if (name.rfind("figure_8.", 0) == 0) return "";
  return text;
}

/// Every file below a folder by its path there.
inline std::map<std::string, std::string> filesWithoutWallClock(
    const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[std::filesystem::relative(entry.path(), folder).string()] =
          withoutWallClock(entry.path());
    }
  }
  return files;
}

/// The same without what jobs of a cluster leave besides, and its place in the folder's record.
inline std::map<std::string, std::string> filesOfAnyEngine(const std::filesystem::path& folder) {
  auto files = filesWithoutWallClock(folder);
  for (auto file = files.begin(); file != files.end();) {
    const bool engine = file->first.rfind("slurm/", 0) == 0 || file->first == "engine.json";
    file = engine ? files.erase(file) : std::next(file);
  }
  std::string& record = files[".cdiff_files"];
  record = std::regex_replace(record, std::regex("(slurm|engine\\.json)\n"), "");
  return files;
}

/// Names of files that are on one side only or differ.
inline std::vector<std::string> differences(const std::map<std::string, std::string>& left,
                                            const std::map<std::string, std::string>& right) {
  std::vector<std::string> names;
  for (const auto& [name, text] : left) {
    if (right.count(name) == 0 || right.at(name) != text) names.push_back(name);
  }
  for (const auto& [name, text] : right) {
    if (left.count(name) == 0) names.push_back(name);
  }
  return names;
}

}  // namespace cdiff::test

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/output_folder.h"
#include "exchange/opendrive_network.h"
#include "exchange/openscenario_writer.h"
#include "exchange/recorded_scene.h"

namespace cdiff::exchange {

/// File formats of an export.
enum class ExportFormat { kOpenScenario, kCommonRoad, kCsv };

/// The format of a name: openscenario, commonroad or csv. Throws InputError naming them.
ExportFormat exportFormat(const std::string& name);

/// What is exported, and how.
struct ExportOptions {
  ExportFormat format = ExportFormat::kOpenScenario;
  ExportedEgo ego = ExportedEgo::kTrajectory;
  SceneOptions scene;
};

/// Exports sessions into one folder: a file each, the OpenDRIVE network of each different network,
/// and index.csv, which says how each case was found. Only files that the program made are
/// replaced.
class SceneExporter {
 public:
  /// The folder is made when the first file is written.
  SceneExporter(std::filesystem::path folder, ExportOptions options);

  /// Exports a session's result folder as a file called `name` with the ending of the format, and
  /// returns what to tell the user. Throws InputError as readScene, openDriveOf and commonRoadFile
  /// do, when the folder cannot be made, and when a file that is not the program's has the name.
  std::string add(const std::filesystem::path& result, const std::string& name);
  /// Writes index.csv: a row per case, by name.
  void finish();

 private:
  std::string networkFileOf(const RecordedScene& scene, std::string& report);
  std::string fileText(const RecordedScene& scene, std::string& report);

  void write(const std::string& name, const std::string& text);

  std::filesystem::path path_;
  ExportOptions options_;
  std::optional<core::OutputFolder> folder_;
  std::map<std::string, std::string> networks_;  ///< file, by SHA-256 of the network
  std::map<std::string, std::string> rows_;      ///< of the index, by name
  std::set<std::string> files_;                  ///< names of the scenes' files
};

}  // namespace cdiff::exchange

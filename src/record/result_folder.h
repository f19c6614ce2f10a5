// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/output_folder.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::record {

// The result folder of a session, and its trace.csv.

/// Folder of a session's result in which `cdiff what_if` keeps its answers.
inline constexpr const char* kWhatIfFolder = "what_if";
/// Trace of a session that ended with its process and kept nothing else.
inline constexpr const char* kCutOffTrace = "trace_cut_off.csv";

/// First line of the trace.
inline constexpr const char* kTraceHeader = "tick,id,role,x,y,heading,speed,throttle,steer,brake\n";

/// Appends the rows of one tick in the snapshot's order. Command cells of vehicles that SUMO drives
/// stay empty.
void appendTraceRows(std::string& text, const traffic::TrafficSnapshot& snapshot);

/// Writes trace.csv: a row per tick and vehicle (map frame, SI units, shortest decimals that read
/// back to the same number), streamed to the disk; it gets its name when it is whole.
class TraceWriter {
 public:
  /// Opens the file. `folder` must outlive the object. Throws InputError naming the path.
  explicit TraceWriter(core::OutputFolder& folder);

  /// Appends the rows of one tick.
  void write(const traffic::TrafficSnapshot& snapshot);
  /// Gives the file its name and answers its SHA-256. Call once.
  std::string finish();

 private:
  void flush();

  core::PendingFile file_;
  std::string buffer_;
  core::Sha256 hash_;
};

// Reads trace.csv back (map frame, SI units).

/// One vehicle at one tick.
struct TraceRow {
  std::uint64_t tick = 0;
  std::string id;
  traffic::VehicleRole role = traffic::VehicleRole::kBackground;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< center of the box [m]
  double heading = 0.0;                                ///< [rad]
  double speed = 0.0;                                  ///< [m/s]
  std::optional<traffic::ControlAction> action;        ///< that led here; absent: SUMO drove
};

/// All rows in the file's order: by tick, the ego first, then CBVs. Throws InputError naming file
/// and line for anything that is not a trace.
std::vector<TraceRow> readTrace(const std::filesystem::path& file);

/// Result folders of sessions: the folder itself, those of a batch's runs, or the sub-folders that
/// hold a session's result, by name. Throws InputError for a folder without any.
std::vector<std::filesystem::path> sessionFolders(const std::filesystem::path& folder);

/// Throws InputError when another process writes into the folder, when it holds anything of a
/// session or a batch, unless earlier sessions are to be overwritten (a batch never is), or when it
/// holds a file of a session's names that this program did not make. Names what it found. A folder
/// that is absent is free.
void requireFreeFolder(const std::filesystem::path& folder, bool overwrite);

/// The result folder of a session, claimed by the one process that writes it: locked against a
/// second one, and without what an earlier session left.
class ResultFolder {
 public:
  /// Makes and locks the folder, checks it as requireFreeFolder does, and removes the files that an
  /// earlier session made, with the answers about it. `program` names this writer to a second one
  /// ("cdiff run"). Throws InputError; nothing is removed then.
  ResultFolder(const std::filesystem::path& folder, const std::string& program, bool overwrite);

 private:
  core::OutputFolder folder_;
};

}  // namespace cdiff::record

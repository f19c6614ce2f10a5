// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/result_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <set>
#include <string_view>
#include <utility>

#include "core/csv.h"
#include "core/file.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

constexpr std::size_t kBufferSize = 1 << 16;  // [bytes]

void appendNumber(std::string& row, double value) {
  row += ',';
  row += core::formatNumber(value);
}

void appendRow(std::string& text, const std::string& tick, const traffic::Vehicle& vehicle) {
  text += tick;
  text += ',';
  text += core::csvCell(vehicle.id);
  text += ',';
  text += traffic::toText(vehicle.role);
  appendNumber(text, vehicle.state.position.x());
  appendNumber(text, vehicle.state.position.y());
  appendNumber(text, vehicle.state.heading);
  appendNumber(text, vehicle.state.speed);
  if (vehicle.applied_action) {
    appendNumber(text, vehicle.applied_action->throttle);
    appendNumber(text, vehicle.applied_action->steer);
    appendNumber(text, vehicle.applied_action->brake);
  } else {
    text += ",,,";
  }
  text += '\n';
}

}  // namespace

void appendTraceRows(std::string& text, const traffic::TrafficSnapshot& snapshot) {
  const std::string tick = std::to_string(snapshot.tick);
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) appendRow(text, tick, vehicle);
}

TraceWriter::TraceWriter(core::OutputFolder& folder) : file_(folder, "trace.csv") {
  buffer_.reserve(2 * kBufferSize);
  buffer_ = kTraceHeader;
}

void TraceWriter::write(const traffic::TrafficSnapshot& snapshot) {
  appendTraceRows(buffer_, snapshot);
  const bool begins = snapshot.tick == 1;  // scripts/session sees by the file that a session drives
  if (begins || buffer_.size() >= kBufferSize) flush();
}

std::string TraceWriter::finish() {
  flush();
  file_.finish();
  return hash_.finish();
}

void TraceWriter::flush() {
  hash_.update(buffer_);
  file_.append(buffer_);
  buffer_.clear();
}

namespace {

using traffic::VehicleRole;

std::optional<VehicleRole> roleOf(const std::string& text) {
  for (const VehicleRole role : {VehicleRole::kEgo, VehicleRole::kCbv, VehicleRole::kBackground}) {
    if (text == traffic::toText(role)) return role;
  }
  return std::nullopt;
}

/// The last three cells; nullopt for a cell that is no number. Empty ones are no action.
std::optional<std::optional<traffic::ControlAction>> actionOf(
    const std::vector<std::string>& cells) {
  if (cells[7].empty() && cells[8].empty() && cells[9].empty())
    return std::optional<traffic::ControlAction>();
  const auto throttle = core::parseNumber(cells[7]);
  const auto steer = core::parseNumber(cells[8]);
  const auto brake = core::parseNumber(cells[9]);
  if (!throttle || !steer || !brake) return std::nullopt;
  return traffic::ControlAction{*throttle, *steer, *brake};
}

std::optional<TraceRow> traceRowOf(std::string_view line) {
  const std::vector<std::string> cells = core::csvCells(line);
  if (cells.size() != 10) return std::nullopt;
  const auto tick = core::parseNumber(cells[0]);
  const auto role = roleOf(cells[2]);
  const auto x = core::parseNumber(cells[3]);
  const auto y = core::parseNumber(cells[4]);
  const auto heading = core::parseNumber(cells[5]);
  const auto speed = core::parseNumber(cells[6]);
  const auto action = actionOf(cells);
  if (!tick || *tick < 0.0 || !role || !x || !y || !heading || !speed || !action)
    return std::nullopt;
  return TraceRow{
      static_cast<std::uint64_t>(*tick), cells[1], *role, {*x, *y}, *heading, *speed, *action};
}

}  // namespace

std::vector<TraceRow> readTrace(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "trace");
  const std::string_view header = kTraceHeader;
  if (text.compare(0, header.size(), header) != 0) {
    throw core::InputError("'" + file.string() + "' is no trace; its first line must be " +
                           std::string(header.substr(0, header.size() - 1)));
  }
  std::vector<TraceRow> rows;
  for (const core::CsvRow& read : core::csvRows(text)) {
    if (read.line == 1) continue;  // the header
    const auto row = read.ended ? traceRowOf(read.text) : std::nullopt;
    if (!row) {
      throw core::InputError(file.string() + ":" + std::to_string(read.line) +
                             ": no row of a trace (tick, id, role, finite numbers, line end)");
    }
    rows.push_back(*row);
  }
  return rows;
}

namespace {

namespace fs = std::filesystem;

/// What makes a folder one with a result.
constexpr std::array<const char*, 10> kSessionFiles = {
    "session.yaml", "trace.csv",   "plans.csv",   "vehicles.csv", "summary.json",
    "junit.xml",    "report.html", "session.bag", "session.mp4",  "session.bag.active"};
/// What the node graph leaves besides.
constexpr const char* kExitCodeFile = "exit_code";
constexpr const char* kReserveFolder = ".reserve";
constexpr const char* kBatchFile = "matrix.yaml";

void requireFree(const fs::path& folder, bool overwrite) {
  std::error_code error;
  if (fs::exists(folder / kBatchFile, error)) {
    throw core::InputError("'" + folder.string() + "' holds the results of a batch (" + kBatchFile +
                           "); give another folder");
  }
  std::vector<std::string> names(kSessionFiles.begin(), kSessionFiles.end());
  names.emplace_back(kExitCodeFile);
  core::OutputFolder::requireFree(folder, names);
  if (fs::exists(fs::symlink_status(folder / kReserveFolder, error)) &&
      !core::OutputFolder::lists(folder, kReserveFolder)) {
    throw core::InputError("'" + (folder / kReserveFolder).string() +
                           "' is no folder that this program made; move it away, or give another "
                           "folder");
  }
  if (overwrite) return;
  for (const char* name : kSessionFiles) {
    if (!fs::exists(folder / name, error)) continue;
    throw core::InputError("'" + folder.string() + "' holds an earlier result (" + name +
                           "); give another folder, or overwrite it (--overwrite, in launch "
                           "files overwrite:=true)");
  }
}

}  // namespace

std::vector<fs::path> sessionFolders(const fs::path& folder) {
  constexpr const char* kSession = "session.yaml";
  if (core::isFile(folder / kSession)) return {folder};
  const fs::path runs = core::isFile(folder / kBatchFile) ? folder / "runs" : folder;
  std::vector<fs::path> folders;
  if (core::isFolder(runs)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(runs)) {
      if (core::isFile(entry.path() / kSession)) folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  if (!folders.empty()) return folders;
  throw core::InputError("'" + folder.string() +
                         "' holds no session's result: it has no session.yaml, nor has a "
                         "folder in it");
}

void requireFreeFolder(const fs::path& folder, bool overwrite) {
  core::FolderLock::requireUnlocked(folder);
  requireFree(folder, overwrite);
}

ResultFolder::ResultFolder(const fs::path& folder, const std::string& program, bool overwrite)
    : folder_(folder, program) {
  requireFree(folder, overwrite);
  if (core::OutputFolder::lists(folder, kWhatIfFolder) && core::isFolder(folder / kWhatIfFolder))
    core::OutputFolder(folder / kWhatIfFolder).clear();
  std::set<std::string> earlier(kSessionFiles.begin(), kSessionFiles.end());
  earlier.insert({kExitCodeFile, kCutOffTrace, kReserveFolder, kWhatIfFolder});
  folder_.remove(earlier);
  folder_.removeUnfinished();
}

}  // namespace cdiff::record

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/recorded_traffic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "core/csv.h"
#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "realism/recording.h"

namespace cdiff::realism {
namespace {

namespace fs = std::filesystem;
using core::InputError;

/// Place of each wanted column in the file's header.
using Columns = std::vector<std::size_t>;

enum Column : std::size_t { kRecording, kVehicle, kTime, kX, kY, kHeading, kLength, kWidth };

Columns columnsOf(const std::vector<std::string>& header, const std::string& file) {
  Columns columns;
  std::vector<std::string> missing;
  for (const std::string& name : recordedColumns()) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) missing.push_back(name);
    columns.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  if (missing.empty()) return columns;
  throw InputError(file + ": no recorded traffic: missing column" +
                   (missing.size() > 1 ? "s " : " ") + core::joinText(missing, ", ") +
                   "; expected " + core::joinText(recordedColumns(), ", ") +
                   " (others may stand beside them)");
}

std::string_view withoutReturn(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// One row of the file.
struct Row {
  std::string recording;
  std::string vehicle;
  std::size_t step = 0;
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  ///< length, width [m]
  TrackState state;
};

class RecordedReader {
 public:
  explicit RecordedReader(const fs::path& file) : file_(file.string()) {
    const std::string text = core::readFile(file, "recorded traffic");
    std::size_t begin = 0;
    for (; begin < text.size(); ++line_) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      take(withoutReturn(std::string_view(text).substr(begin, end - begin)));
      begin = end + 1;
    }
    if (recordings_.empty()) {
      if (line_ == 1) columns_ = columnsOf({}, file_);
      throw InputError(file_ + ": recorded traffic without a row");
    }
  }
  std::vector<Recording> take() { return std::move(recordings_); }

 private:
  void take(std::string_view line) {
    if (line.empty()) return;
    const std::vector<std::string> cells = core::csvCells(line);
    if (columns_.empty()) {
      columns_ = columnsOf(cells, file_);
      return;
    }
    if (cells.size() <= *std::max_element(columns_.begin(), columns_.end()))
      throw refuse("has " + std::to_string(cells.size()) + " cells, fewer than the header");
    append(rowOf(cells));
  }

  InputError refuse(const std::string& why) const {
    return InputError(file_ + ":" + std::to_string(line_) + ": " + why);
  }

  double number(const std::vector<std::string>& cells, Column column) const {
    const std::string& cell = cells[columns_[column]];
    const auto value = core::parseNumber(cell);
    if (!value)
      throw refuse("column " + recordedColumns()[column] + " holds '" + core::shortened(cell) +
                   "', expected a finite number");
    return *value;
  }

  Row rowOf(const std::vector<std::string>& cells) const {
    Row row;
    row.recording = cells[columns_[kRecording]];
    row.vehicle = cells[columns_[kVehicle]];
    const double time = number(cells, kTime);
    constexpr double kLongest = 1e7;  // [s]
    const double step = std::round(time / kStep);
    if (std::abs(time) > kLongest)
      throw refuse("time " + core::formatNumber(time) + " s; expected at most " +
                   core::formatNumber(kLongest));
    if (step < 0.0 || std::abs(time - step * kStep) > 0.1 * kStep)
      throw refuse("time " + core::formatNumber(time) +
                   " s is no multiple of 0.1 s from 0 on; recorded traffic must have 10 rows a "
                   "second");
    row.step = static_cast<std::size_t>(step);
    row.size = {number(cells, kLength), number(cells, kWidth)};
    if (row.size.minCoeff() <= 0.0) throw refuse("length and width must be positive");
    row.state.position = {number(cells, kX), number(cells, kY)};
    row.state.heading = number(cells, kHeading);
    return row;
  }

  Recording& recordingOf(const std::string& name) {
    const auto found = places_.try_emplace(name, recordings_.size()).first;
    if (found->second == recordings_.size())
      recordings_.push_back({name, name.substr(0, name.find('-')), {}});
    return recordings_[found->second];
  }

  void append(const Row& row) {
    std::vector<Track>& tracks = recordingOf(row.recording).tracks;
    const bool known = !tracks.empty() && tracks.back().id == row.vehicle;
    std::size_t& end = ends_[{row.recording, row.vehicle}];
    if (row.step < end)
      throw refuse("vehicle '" + core::shortened(row.vehicle) +
                   "' goes back in time; rows of a vehicle must be in order");
    if (!known && end != 0 && end == row.step)
      throw refuse("rows of vehicle '" + core::shortened(row.vehicle) +
                   "' do not lie together; sort them by recording, vehicle and time");
    if (!known || row.step > tracks.back().end())
      tracks.push_back({row.vehicle, "", row.size.x(), row.size.y(), row.step, {}});
    tracks.back().states.push_back(row.state);
    end = tracks.back().end();
  }

  std::string file_;
  std::size_t line_ = 1;
  Columns columns_;
  std::vector<Recording> recordings_;
  std::map<std::string, std::size_t> places_;                        ///< of recordings by name
  std::map<std::pair<std::string, std::string>, std::size_t> ends_;  ///< of vehicles [steps]
};

bool hasRecordedColumns(const fs::path& file) {
  const std::string text = core::readFile(file, "recorded traffic");
  const auto header =
      core::csvCells(withoutReturn(std::string_view(text).substr(0, text.find('\n'))));
  return std::all_of(recordedColumns().begin(), recordedColumns().end(), [&](const auto& name) {
    return std::find(header.begin(), header.end(), name) != header.end();
  });
}

}  // namespace

const std::vector<std::string>& recordedColumns() {
  static const std::vector<std::string> columns = {"recording", "vehicle", "t",      "x",
                                                   "y",         "heading", "length", "width"};
  return columns;
}

std::vector<Recording> readRecordedTraffic(const fs::path& file) {
  return RecordedReader(file).take();
}

std::vector<Recording> readRecordedTraffic(const std::vector<fs::path>& files) {
  std::vector<fs::path> found;
  for (const fs::path& file : files) {
    if (!core::isFolder(file)) {
      found.push_back(file);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(file)) {
      if (entry.path().extension() == ".csv" && hasRecordedColumns(entry.path()))
        inside.push_back(entry.path());
    }
    if (inside.empty())
      throw InputError("'" + file.string() + "' holds no *.csv file of recorded traffic (columns " +
                       core::joinText(recordedColumns(), ", ") + ")");
    std::sort(inside.begin(), inside.end());
    found.insert(found.end(), inside.begin(), inside.end());
  }
  std::vector<Recording> all;
  for (const fs::path& file : found) {
    for (Recording& recording : readRecordedTraffic(file)) all.push_back(std::move(recording));
  }
  return all;
}

}  // namespace cdiff::realism

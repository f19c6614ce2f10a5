// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/recorded_session.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "realism/recording.h"
#include "record/result_folder.h"

namespace cdiff::realism {
namespace {

namespace fs = std::filesystem;
using core::InputError;

double simulationStep(const fs::path& folder) {
  const fs::path file = folder / "session.yaml";
  try {
    return YAML::Load(core::readFile(file, "session record",
                                     core::kLargestOptionsFile))["scenario"]["simulation_step"]
        .as<double>();
  } catch (const YAML::Exception& error) {
    throw InputError(
        "'" + file.string() +
        "' does not say the simulation step (scenario.simulation_step): " + error.what());
  }
}

/// Ticks from one step of the recording to the next.
std::uint64_t ticksPerStep(const fs::path& folder) {
  const double step = simulationStep(folder);
  const double ticks = std::round(kStep / step);
  if (ticks >= 1.0 && std::abs(ticks * step - kStep) < 1e-9)
    return static_cast<std::uint64_t>(ticks);
  throw InputError("'" + folder.string() + "': simulation_step is " + core::formatNumber(step) +
                   " s; expected 0.1 s to be a multiple of it");
}

/// Makes a recording of the rows of a trace, which come tick by tick.
class TraceRecorder {
 public:
  explicit TraceRecorder(std::uint64_t ticks_per_step) : ticks_(ticks_per_step) {}

  void add(const record::TraceRow& row) {
    if (!rows_.empty() && rows_.front().tick != row.tick) closeTick();
    rows_.push_back(row);
  }
  Recording take() {
    closeTick();
    return std::move(recording_);
  }

 private:
  using Key = std::pair<std::string, traffic::VehicleRole>;

  void closeTick() {
    for (const record::TraceRow& row : rows_) {
      if (row.tick % ticks_ == 0) append(row);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t j = i + 1; j < rows_.size(); ++j) {
        if (!touch(rows_[i], rows_[j])) continue;
        noteContact(rows_[i]);
        noteContact(rows_[j]);
      }
    }
    rows_.clear();
  }

  void append(const record::TraceRow& row) {
    std::vector<Track>& tracks = recording_.tracks;
    const std::size_t step = row.tick / ticks_;
    const auto [found, fresh] = latest_.try_emplace(Key{row.id, row.role}, tracks.size());
    if (fresh || tracks[found->second].end() != step) {
      found->second = tracks.size();
      tracks.push_back({row.id, traffic::toText(row.role)});
      tracks.back().first = step;
    }
    tracks[found->second].states.push_back({row.position, row.heading, 0.0});
  }

  static bool touch(const record::TraceRow& first, const record::TraceRow& second) {
    const Track size;  // the trace does not hold it
    const auto box = [&](const record::TraceRow& row) {
      return geometry::OrientedBox{row.position, row.heading, size.length, size.width};
    };
    const double reach = std::hypot(size.length, size.width);
    return (first.position - second.position).norm() <= reach &&
           geometry::overlap(box(first), box(second));
  }

  void noteContact(const record::TraceRow& row) {
    const auto found = latest_.find(Key{row.id, row.role});
    if (found != latest_.end()) recording_.tracks[found->second].noteContact(row.tick / ticks_);
  }

  std::uint64_t ticks_;
  std::vector<record::TraceRow> rows_;  ///< of one tick
  Recording recording_;
  std::map<Key, std::size_t> latest_;  ///< track of each vehicle and role
};

/// Of the vehicle's tracks the one that covers the latest step up to `step`.
Track* trackUpTo(const std::string& vehicle, std::size_t step, Recording& recording) {
  Track* latest = nullptr;
  for (Track& track : recording.tracks) {
    if (track.id != vehicle || track.first > step) continue;
    if (latest == nullptr || track.end() > latest->end()) latest = &track;
  }
  return latest;
}

/// Notes a contact at the vehicle's last step up to `step`.
void noteContact(const std::string& vehicle, std::size_t step, Recording& recording) {
  Track* track = trackUpTo(vehicle, step, recording);
  if (track != nullptr) track->contacts.insert(std::min(step, track->end() - 1));
}

/// The contacts of ego and CBVs that the session counted, by the vehicles' own sizes and levels:
/// those of the ego with their ticks, those of CBVs by when they left.
void noteCountedContacts(const fs::path& file, std::uint64_t ticks, Recording& recording) {
  using nlohmann::json;
  if (!core::isFile(file)) return;
  try {
    const json summary = core::readJson(file, "summary");
    for (const json& contact : summary.at("ego").at("contacts")) {
      const std::size_t step = contact.at("tick").get<std::uint64_t>() / ticks;
      noteContact(traffic::kEgoId, step, recording);
      noteContact(contact.at("with"), step, recording);
    }
    for (const json& selection : summary.at("cbv").at("selections")) {
      const json& released = selection.at("released_tick");
      if (!selection.at("contact_with").is_string() || !released.is_number()) continue;
      noteContact(selection.at("vehicle_id"), released.get<std::uint64_t>() / ticks, recording);
    }
  } catch (const json::exception& error) {
    throw InputError("'" + file.string() + "' is no summary of a session: " +
                     core::jsonFault(error) + "; expected the result of a session of this version");
  }
}

}  // namespace

Recording readResult(const fs::path& folder) {
  const std::uint64_t ticks = ticksPerStep(folder);
  TraceRecorder recorder(ticks);
  for (const record::TraceRow& row : record::readTrace(folder / "trace.csv")) recorder.add(row);
  Recording recording = recorder.take();
  noteCountedContacts(folder / "summary.json", ticks, recording);
  recording.name = folder.filename().string();
  return recording;
}

}  // namespace cdiff::realism

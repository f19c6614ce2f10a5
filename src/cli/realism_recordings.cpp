// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/realism_recordings.h"

#include <algorithm>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "evaluation/executor.h"
#include "realism/recorded_session.h"
#include "realism/recorded_traffic.h"
#include "realism/recording.h"
#ifdef E2E_CDIFF_WITH_ROS
#include "node_graph/bags/replay.h"
#include "realism/recording_builder.h"
#endif

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using realism::Recording;

Recording readBag(const fs::path& file) {
#ifdef E2E_CDIFF_WITH_ROS
  node_graph::RecordedSession session(file);
  realism::SessionRecorder recorder;
  node_graph::showTicks(session, {&recorder});
  Recording recording = recorder.take();
  recording.name = recording.site = file.stem().string();
  return recording;
#else
  throw InputError("'" + file.string() + "': this program was built without ROS and reads no bags");
#endif
}

/// Gathers courses by driver in the order in which drivers appear.
class Drivers {
 public:
  void add(const std::string& driver, const Recording& recording) {
    append(driver, recording, traffic::VehicleRole::kCbv);
    const auto background =
        realism::pooledCourses({recording}, toText(traffic::VehicleRole::kBackground));
    background_.insert(background_.end(), background.begin(), background.end());
  }
  realism::PooledDrivers take() {
    drivers_.emplace_back("SUMO background", std::move(background_));
    return std::move(drivers_);
  }

 private:
  void append(const std::string& driver, const Recording& recording, traffic::VehicleRole role) {
    auto found = std::find_if(drivers_.begin(), drivers_.end(),
                              [&](const auto& entry) { return entry.first == driver; });
    if (found == drivers_.end()) found = drivers_.insert(found, {driver, {}});
    const auto courses = realism::pooledCourses({recording}, toText(role));
    found->second.insert(found->second.end(), courses.begin(), courses.end());
  }

  realism::PooledDrivers drivers_;
  std::vector<realism::Course> background_;
};

/// Levels that say who drives; the method where it is not the default one.
std::string driverOf(const evaluation::Factors& factors) {
  const std::string usual = session::ScenarioOptions().method;
  std::vector<std::string> words;
  for (const char* factor : {"variant", "cbv_planner", "mode", "method", "guidance_profile"}) {
    const auto found = factors.find(factor);
    if (found == factors.end() || found->second.empty()) continue;
    if (factor != std::string("method") || found->second != usual)
      words.push_back(evaluation::levelName(factor, found->second));
  }
  return core::joinText(words, ", ");
}

void addBatch(const fs::path& folder, Drivers& drivers) {
  for (const evaluation::RunRecord& record : evaluation::readRecords(folder)) {
    if (!record.complete()) continue;
    const fs::path run = evaluation::runFolder(folder, record.id);
    drivers.add(driverOf(record.factors), realism::readResult(run));
  }
}

}  // namespace

std::vector<Recording> readLogs(const std::vector<fs::path>& files) {
  std::vector<Recording> all;
  for (const fs::path& file : files) {
    if (file.extension() == ".bag") {
      all.push_back(readBag(file));
      continue;
    }
    for (Recording& recording : realism::readRecordedTraffic(std::vector<fs::path>{file}))
      all.push_back(std::move(recording));
  }
  return all;
}

realism::PooledDrivers pooledDrivers(const std::vector<fs::path>& folders) {
  Drivers drivers;
  std::set<fs::path> seen;
  for (const fs::path& given : folders) {
    if (!seen.insert(fs::weakly_canonical(given)).second)
      throw InputError("'" + given.string() + "' is there twice; its courses would count twice");
    const fs::path folder = fs::absolute(given).lexically_normal();
    if (core::isFile(folder / "trace.csv")) {
      const bool slash = !folder.has_filename();
      drivers.add((slash ? folder.parent_path() : folder).filename().string(),
                  realism::readResult(folder));
    } else if (core::isFolder(folder / "runs")) {
      addBatch(folder, drivers);
    } else {
      throw InputError("'" + given.string() +
                       "' is no result folder: neither trace.csv of a session nor runs/ of a "
                       "batch is in it");
    }
  }
  return drivers.take();
}

}  // namespace cdiff::cli

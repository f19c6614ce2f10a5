// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "realism/recorded_traffic.h"
#include "record/result_folder.h"

namespace cdiff::realism {
namespace {

namespace fs = std::filesystem;
using core::InputError;

double simulationStep(const fs::path& folder) {
  const fs::path file = folder / "session.yaml";
  try {
    return YAML::Load(core::readFile(file, "session record"))["scenario"]["simulation_step"]
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

}  // namespace

Recording readResult(const fs::path& folder) {
  const std::uint64_t ticks = ticksPerStep(folder);
  Recording recording;
  recording.name = folder.filename().string();
  std::map<std::pair<std::string, traffic::VehicleRole>, std::size_t> open;  // latest track of each
  for (const record::TraceRow& row : record::readTrace(folder / "trace.csv")) {
    if (row.tick % ticks != 0) continue;
    const std::size_t step = row.tick / ticks;
    const auto [found, fresh] = open.try_emplace({row.id, row.role}, recording.tracks.size());
    if (fresh || recording.tracks[found->second].end() != step) {
      found->second = recording.tracks.size();
      recording.tracks.push_back({row.id, traffic::toText(row.role)});
      recording.tracks.back().first = step;
    }
    recording.tracks[found->second].states.push_back({row.position, row.heading, 0.0});
  }
  return recording;
}

}  // namespace cdiff::realism

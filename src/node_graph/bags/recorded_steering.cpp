// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/recorded_steering.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/recorded_session.h"
#include "node_graph/messages/traffic_conversions.h"
#include "session/steering_file.h"

namespace cdiff::node_graph {

std::vector<session::SteeringEntry> readSteering(const std::filesystem::path& source) {
  if (source.extension() != ".bag") return session::readSteering(source);
  RecordedSession session(source, RecordedImages::kAll);
  if (session.setup().options().real_time_factor > 0.0) session::refusePaced(source);
  std::vector<session::SteeringEntry> entries;
  while (const auto snapshot = session.next()) {
    for (const traffic::SteeringChange& change : fromMsg(snapshot->steering))
      entries.push_back(session::entryOf(change, snapshot->time));
  }
  if (session.findings().empty()) return entries;
  throw core::InputError("bag '" + source.string() + "': its steering cannot be repeated: " +
                         core::joinText(session.findings(), "; "));
}

session::SteeredSession steeredSession(const std::filesystem::path& source) {
  if (source.extension() != ".bag") return session::steeredSession(source);
  const RecordedSession session(source);
  const session::ScenarioOptions& options = session.setup().options();
  return {options.name, options.seed, session.info().package_version};
}

}  // namespace cdiff::node_graph

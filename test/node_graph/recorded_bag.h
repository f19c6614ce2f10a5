// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A real short session with its bag, and bags made of it: messages left out, changed, or added.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "collection/collection_loop.h"
#include "node_graph/bags/session_bag_writer.h"
#include "page/result_writer.h"
#include "rosbag/bag.h"
#include "rosbag/view.h"
#include "session/closed_loop.h"
#include "session/session_request.h"

namespace cdiff::test {

/// Result folder and bag of a session, driven in this process.
inline void runInOneProcess(const session::SessionRequest& request,
                            const std::filesystem::path& folder) {
  const session::SessionSetup setup(session::resolveRequest(request));
  session::ClosedLoop loop(setup);
  page::ResultWriter writer(setup, {"test", "SUMO", true}, folder);
  node_graph::SessionBagWriter bag(setup, folder / "session.bag", {"test", "SUMO"});
  loop.addObserver(writer);
  loop.addObserver(bag);
  const std::atomic<bool> never{false};
  loop.run(never);
  writer.finish(1.0);
  bag.finish();
}

/// Result folder and bag of a session of crossing_left_turn that ends by its time limit; `settings`
/// are keys of the scenario.
inline void recordSession(const std::filesystem::path& folder,
                          const std::vector<std::string>& settings) {
  session::SessionRequest request;
  request.scenario = "crossing_left_turn";
  request.seed = "2";
  request.set = settings;
  runInOneProcess(request, folder);
}

/// The bag of a session of crossing_left_turn that is driven for training data; `observe` is called
/// before it runs and may add observers.
inline void recordCollection(
    const std::filesystem::path& file, double duration, bool images,
    const std::function<void(const session::SessionSetup&, collection::CollectionLoop&)>& observe) {
  collection::CollectionOptions options;
  options.duration = duration;
  options.vehicles = 4;
  options.noise.interval = 4.0;
  session::ScenarioOptions wanted = session::loadScenario("crossing_left_turn");
  wanted.seed = 3;
  const auto setup =
      collection::collectionSetup(collection::collectionScenario(wanted, options), options);
  collection::CollectionLoop loop(*setup, options, images);
  node_graph::SessionBagWriter bag(*setup, file, {"test", "SUMO"});
  bag.setNoiseQuery([&](const std::string& id) { return loop.perturbed(id); });
  loop.addObserver(bag);
  observe(*setup, loop);
  const std::atomic<bool> never{false};
  loop.run(never);
  bag.finish();
}

/// Called with each message in order; writes to the new bag what that shall hold.
using BagEdit = std::function<void(const rosbag::MessageInstance& message, rosbag::Bag& to)>;

/// Writes a message as it is.
inline void keep(const rosbag::MessageInstance& message, rosbag::Bag& to) {
  to.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
}

inline void editBag(const std::filesystem::path& from, const std::filesystem::path& to,
                    const BagEdit& edit) {
  const rosbag::Bag source(from.string(), rosbag::bagmode::Read);
  rosbag::Bag target(to.string(), rosbag::bagmode::Write);
  target.setCompression(rosbag::compression::LZ4);
  for (const rosbag::MessageInstance& message : rosbag::View(source)) edit(message, target);
  target.close();
}

}  // namespace cdiff::test

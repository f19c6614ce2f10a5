// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <map>
#include <string>

#include "collection/collection_loop.h"
#include "collection/session_samples.h"
#include "learning/samples/scene.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// What the record of a session asks about a driven vehicle, by its id.
struct DriverQueries {
  std::function<learning::SceneDriver(const std::string& id)> driver;
  std::function<bool(const std::string& id)> noisy;  ///< whether its last action carries noise
};

/// Answered by a session that runs, which must outlive them.
DriverQueries driverQueries(const CollectionLoop& loop);

/// Keeps what a scene holds of a session that runs (map frame, SI units): every decision, drive and
/// contact. Observes all ticks of a CollectionLoop.
class SceneRecorder : public session::SessionObserver {
 public:
  /// `setup` must outlive the recorder.
  SceneRecorder(const session::SessionSetup& setup, DriverQueries queries);

  void observe(const session::TickRecord& record) override;
  /// The session so far; the recorder is spent.
  learning::Scene take() { return std::move(scene_); }

 private:
  void addDrive(const std::string& id, std::uint64_t tick, const map::Route& route);
  void observeSelection(const cbv::CbvSelection& selection);

  const session::SessionSetup& setup_;
  DriverQueries queries_;
  learning::Scene scene_;
  std::map<DriveKey, std::size_t> drives_;
};

}  // namespace cdiff::collection

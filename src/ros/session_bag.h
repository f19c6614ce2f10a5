// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The bag of a session that one process drives: the same topics, stamps and order as the
/// recorder's, and the images that planners or records were given.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "ros/bag_file.h"
#include "ros/metric_reporter.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::ros {

/// What is added to the name of the planner of an action that carries noise.
inline constexpr const char* kNoiseMark = "+noise";

/// Who made the session, for SessionInfo.
struct BagOrigin {
  std::string deployment;         ///< "cdiff run", "cdiff collect"
  std::string simulator_version;  ///< "SUMO 1.15.0"
};

class SessionBag : public session::SessionObserver {
 public:
  /// `setup` must outlive the object. Throws InputError naming the file when it cannot be written.
  SessionBag(const session::SessionSetup& setup, const std::filesystem::path& file,
             const BagOrigin& origin);
  ~SessionBag() override;

  /// Asked at each action whether it carries noise; without it none does.
  void setNoiseQuery(std::function<bool(const std::string& vehicle_id)> query) {
    noisy_ = std::move(query);
  }
  void observe(const session::TickRecord& record) override;
  /// Gives the file its name. Without this call it stays FILE.active.
  void finish();
  /// Nothing of the bag stays.
  void discard() { file_.discard(); }

 private:
  std::vector<Answer> answersOf(const session::TickRecord& record) const;
  std::string plannerOf(int slot) const;

  const session::SessionSetup& setup_;
  BagFile file_;
  MetricReporter reporter_;
  std::function<bool(const std::string&)> noisy_;
};

}  // namespace cdiff::ros

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "session/session_setup.h"
#include "suite/suite.h"

namespace cdiff::planners {

/// The ego routes on which PPO learns, and those on networks that it never sees: a route suite,
/// divided by network.
class PpoRoutes {
 public:
  /// `held_out_share` of the networks is held out (by their names, whatever the seed): one at
  /// least, never all; 0: none, and the training routes judge. `cbvs` are driven at a time. Throws
  /// InputError for a suite that cannot be read or is for evaluation (suite::requireForTraining),
  /// and where all routes lie on one network.
  PpoRoutes(const std::string& suite, double held_out_share, std::int64_t cbvs);

  /// Indices of the routes.
  const std::vector<std::size_t>& training() const { return training_; }
  const std::vector<std::size_t>& heldOut() const { return held_out_; }
  std::size_t networks() const { return networks_; }
  std::size_t heldOutNetworks() const { return held_out_networks_; }
  const std::string& name(std::size_t route) const { return suite_.routes.at(route).name; }
  /// SHA-256 over the manifest and the networks.
  const std::string& sha256() const { return sha256_; }
  const std::string& suiteName() const { return suite_.name; }

  /// The session of a route: ego PDM-Lite, CBVs by RIFT's rule in training, generated traffic,
  /// green lights. May be called from several threads.
  std::unique_ptr<session::SessionSetup> setup(std::size_t route, std::int64_t seed) const;

 private:
  void divide(double held_out_share);
  void hash();
  session::ScenarioOptions scenarioOf(const suite::SuiteRoute& route, std::int64_t cbvs) const;

  suite::Suite suite_;
  std::vector<session::ScenarioOptions> scenarios_;
  std::vector<std::size_t> training_;
  std::vector<std::size_t> held_out_;
  std::size_t networks_ = 0;
  std::size_t held_out_networks_ = 0;
  std::string sha256_;
};

}  // namespace cdiff::planners

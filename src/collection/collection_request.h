// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "collection/collection_options.h"
#include "session/scenario_options.h"
#include "session/session_setup.h"

namespace cdiff::collection {

// The scenario of a session that collects data, made of one that is driven.

/// The scenario as collection runs it: its protocol ends it only after the duration (or with the
/// ego's route); lights and density of generated demand are drawn from the seed, and every other
/// seed generates the demand of a scenario that brings a file. The expert, a scenario's default ego
/// planner, takes the place of planners that see, for they learn from it.
session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options);

/// Its set-up, with the ego route lengthened by random turns to what the duration needs.
std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options);

// What `cdiff collect` is asked for: options of a session, and where its files lie in the data
// set's folder.

/// One session.
struct CollectRequest {
  std::string scenario;  ///< shipped name or file
  std::int64_t seed = 1;
  std::filesystem::path results;
  double duration = 60.0;  ///< [s]
  bool keep_bag = false;
  bool images = true;            ///< without: the bag alone
  std::vector<std::string> set;  ///< key=value each
};

/// Options of a session, collection's own in the group "collection".
struct CollectSettings {
  session::ScenarioOptions scenario;
  CollectionOptions collection;

  void describe(core::OptionsVisitor& visitor);
};

/// Throws InputError for an unknown scenario, key or value.
CollectSettings resolveCollection(const CollectRequest& request);
/// "SCENARIO_seedN": the name of its files.
std::string sessionName(const CollectSettings& settings);
std::filesystem::path bagFile(const CollectRequest& request, const std::string& name);
std::filesystem::path shardFile(const CollectRequest& request, const std::string& name);
std::filesystem::path statisticsFile(const CollectRequest& request, const std::string& name);

}  // namespace cdiff::collection

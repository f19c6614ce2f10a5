// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The scenario of a session that collects data, made of one that is driven.
#pragma once

#include <memory>

#include "collection/collection_options.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// The scenario as collection runs it: its protocol ends it only after the duration (or with the
/// ego's route); lights and density of generated demand are drawn from the seed, and every other
/// seed generates the demand of a scenario that brings a file. The expert, a scenario's default ego
/// planner, takes the place of planners that see, for they learn from it.
session::ScenarioOptions collectionScenario(session::ScenarioOptions scenario,
                                            const CollectionOptions& options);

/// Its set-up, with the ego route lengthened by random turns to what the duration needs.
std::unique_ptr<session::SessionSetup> collectionSetup(const session::ScenarioOptions& scenario,
                                                       const CollectionOptions& options);

}  // namespace cdiff::collection

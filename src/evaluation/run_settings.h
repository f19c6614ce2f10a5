// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "session/scenario_options.h"

namespace cdiff::evaluation {

/// How the planners of a run work, for the heads of tables: for ego and CBVs with a network the
/// method, sampler, candidates, conditioning and weights; for guided ones the objectives with their
/// weights; then the protocol with its time limit [s]. Equal texts stand for equal settings.
std::string settingsOf(const session::ScenarioOptions& scenario);

}  // namespace cdiff::evaluation

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>

#include "simulation/sumo_link.h"
#include "simulation/sumo_simulator.h"

namespace cdiff::simulation {

// What a session gives to SUMO, and which file is at fault when SUMO refuses it.

/// Starts SUMO and connects. Throws InputError naming the file that is missing or that SUMO
/// refuses, with SUMO's own message.
std::unique_ptr<SumoLink> startSumo(const SumoOptions& options, const SumoSession& session);

/// Whether a sentence of SUMO names ('...') something that the session's demand defines.
bool namesDemand(const std::string& sentence, const SumoSession& session);

/// Throws InputError naming the demand, with SUMO's sentence.
[[noreturn]] void refuseDemand(const SumoSession& session, const std::string& sentence);

}  // namespace cdiff::simulation

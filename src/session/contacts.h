// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Contacts of the vehicles that we drive: boxes that overlap on the same level at one tick.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::session {

/// Contacts of one tick, and who leaves the simulation for them.
struct TickContacts {
  std::vector<traffic::Contact> contacts;
  std::vector<std::string> leaving;  ///< CBVs and background vehicles; one may be there twice
};

/// Looks at the first `driven` of the vehicles, each against all that come after it.
TickContacts findContacts(const std::vector<traffic::Vehicle>& vehicles, std::size_t driven);

}  // namespace cdiff::session

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <exception>
#include <string>
#include <string_view>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::traffic {

// Planners, metrics and nodes of others write what a fault holds: it is kept safe to show (as
// core::plainText) and not too long.

/// At most 1000 letters.
std::string shownFaultText(std::string_view text);
/// Whether memory or a file that was missing is why, which core::failureOf explains.
bool isOfTheSystem(const std::exception& error);
/// The text of what code of others threw, so kept; never empty. What is of the system is explained.
std::string thrownFaultText(const std::exception& error);
/// Name of a node or planner; at most 100 letters.
std::string shownSource(std::string_view source);
/// Source and text so.
Fault shownFault(const Fault& fault);

}  // namespace cdiff::traffic

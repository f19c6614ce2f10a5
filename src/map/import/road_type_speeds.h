// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>

namespace cdiff::map {

/// The OpenDRIVE text in which each lane without a limit has that of its road's type where its
/// section begins, which netconvert does not read. A motorway without a limit has 130 km/h there, a
/// rural road 100 km/h. nullopt when the text already is so, or is no XML.
std::optional<std::string> withSpeedsOfRoadTypes(const std::string& opendrive);

}  // namespace cdiff::map

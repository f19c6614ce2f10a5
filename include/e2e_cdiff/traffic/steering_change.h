// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

namespace cdiff::traffic {

/// A change of a running session that someone asked for: in force from the tick of its snapshot on.
/// Numbers are written as text in SI units, vehicles by their ids.
struct SteeringChange {
  std::string by;      ///< who asked: kSteeredByScenario, or who steers by hand
  std::string what;    ///< what is changed, see namespace `steered`
  std::string before;  ///< value until then; empty where there was none
  std::string after;   ///< value from now on; empty where there is none
};

/// Who asks for the changes that a scenario lists.
inline constexpr const char* kSteeredByScenario = "scenario";

/// What can be steered; "weight." is followed by the name of an objective.
namespace steered {
inline constexpr const char* kProfile = "profile";           ///< guidance profile of the CBVs
inline constexpr const char* kMode = "mode";                 ///< ... that of a mode
inline constexpr const char* kWeight = "weight.";            ///< weight of one objective
inline constexpr const char* kTargetSpeed = "target_speed";  ///< v* of all CBVs [m/s]
inline constexpr const char* kChoose = "choose";             ///< `after` becomes a CBV
inline constexpr const char* kRelease = "release";           ///< `before` is a CBV no more
inline constexpr const char* kPlace = "place";               ///< a background vehicle is added
inline constexpr const char* kRemove = "remove";             ///< `before` is taken away
}  // namespace steered

}  // namespace cdiff::traffic

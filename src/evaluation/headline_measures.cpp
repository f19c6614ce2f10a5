// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/headline_measures.h"

#include <algorithm>

#include "metrics/known_measures.h"

namespace cdiff::evaluation {

const std::vector<std::string>& headlineMeasures() {
  namespace known = metrics::known;
  static const std::vector<std::string> names = {
      known::kCbvEgoCollisions.name, known::kContactsAtFault.name, known::kDrivingScore.name,
      known::kRouteCompletion.name, known::kCbvOffRoad.name};
  return names;
}

bool isHeadline(const std::string& measure) {
  const std::vector<std::string>& names = headlineMeasures();
  return std::find(names.begin(), names.end(), measure) != names.end();
}

}  // namespace cdiff::evaluation

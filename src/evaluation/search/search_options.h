// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace cdiff::evaluation {

/// What `cdiff search` varies and how it proposes cases: a YAML file, by default
/// config/search_spaces/default.yaml.
struct SearchOptions {
  std::int64_t schema_version = 1;
  std::vector<std::string> keys;         ///< "key: low .. high" or "key: a | b" each
  std::vector<std::string> attack_keys;  ///< further ones where the CBVs attack
  std::string method = "evolution";      ///< evolution | random
  std::int64_t batch = 8;                ///< cases that are proposed together
  std::int64_t draws = 16;               ///< first cases of evolution, which are drawn at random
  double fresh = 0.2;                    ///< share of later cases that are drawn at random, too
  std::int64_t elite = 6;                ///< worst cases so far, of which new ones are made
  double change = 0.35;                  ///< share of the keys that a new case changes
  double step = 0.15;                    ///< deviation of a change, in shares of the range
  double timeout = 600.0;                ///< wall time of one session [s]
  std::int64_t retries = 1;              ///< further attempts where a process or its SUMO died

  void describe(core::OptionsVisitor& visitor);
};

/// Reads search options by file name or by the name of those in config/search_spaces. Throws
/// InputError naming file, line and key, or the nearest shipped one.
SearchOptions loadSearchOptions(const std::string& name_or_file);

/// Names of the shipped search options, sorted.
std::vector<std::string> shippedSearchOptions();

}  // namespace cdiff::evaluation

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/statistics.h"
#include "evaluation/system_names.h"

namespace cdiff::evaluation {

/// Which of a batch's systems is the hardest for the ego: the one whose CBVs touch it most often
/// per km. The first is compared with each other one, and the p values are corrected for their
/// number.
struct Ranking {
  std::vector<System> systems;         ///< most contacts per km first; those that drove no CBV last
  std::vector<std::string> not_apart;  ///< names of systems that may be as hard as the first
  double largest_p = 0.0;              ///< of the others, p of the first against them, after Holm
};

/// Of the complete runs among `records`, whose systems are given. Systems are compared over the
/// scenarios, seeds and repetitions that they share.
Ranking rankingOf(const std::vector<System>& systems, const std::vector<RunRecord>& records,
                  const SystemNames& names);

/// "Hardest for the ego: diffusion in attack. Its CBVs touched the ego 18 times in 0.94 km (19.2
/// per km, 95 % [11.4, 30.3])." Then the others, of many the next two and the last, and whether the
/// first is apart from them.
std::vector<std::string> rankingSentences(const Ranking& ranking, const SystemNames& names);

}  // namespace cdiff::evaluation

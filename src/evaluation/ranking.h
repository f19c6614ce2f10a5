// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/statistics.h"
#include "evaluation/system_names.h"

namespace cdiff::evaluation {

/// Which of a batch's systems is the hardest for the ego: the one whose CBVs touch the moving ego
/// most often per km; a contact with a standing one does not rank. The first is compared with each
/// other one, and the p values are corrected for their number.
struct Ranking {
  std::vector<System> systems;  ///< most such contacts per km first; those without a CBV last
  std::string measure;          ///< what ranks: records of earlier versions have all contacts alone
  std::vector<std::string> not_apart;  ///< names of systems that may be as hard as the first
  double largest_p = 0.0;              ///< of the others, p of the first against them, after Holm
};

/// Of the complete runs among `records`, whose systems are given. Systems are compared over the
/// scenarios, seeds and repetitions that they share.
Ranking rankingOf(const std::vector<System>& systems, const std::vector<RunRecord>& records,
                  const SystemNames& names);

/// A ranking in words.
struct RankingText {
  std::vector<std::string> sentences;  ///< the answer first
  std::vector<std::string> folded;     ///< the systems after the first, where they are many
};

/// "Hardest for the ego driven by pdm_lite: diffusion in attack. Its CBVs touched the moving ego 18
/// times in 0.94 km (19.2 per km, 95 % exact Poisson [11.4, 30.3]), and 2 times with the ego
/// standing." Then the others, whether the first is apart from them, and how contacts at the ego's
/// fault and driving scores order them where that differs.
RankingText rankingText(const Ranking& ranking, const SystemNames& names);

}  // namespace cdiff::evaluation

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Records of runs written in a test.
#pragma once

#include <string>

#include "evaluation/run_record.h"

namespace cdiff::test {

/// Levels of the factors that tests vary.
struct Levels {
  std::string scenario = "s";
  std::string seed = "1";
  std::string profile = "none";
  std::string repetition = "1";
};

inline evaluation::RunRecord recordWithout(const Levels& levels, const std::string& status) {
  evaluation::RunRecord record;
  record.factors = {{"scenario", levels.scenario},
                    {"ego_planner", "pdm_lite"},
                    {"cbv_planner", "pdm_lite"},
                    {"mode", "naturalistic"},
                    {"method", "default"},
                    {"guidance_profile", levels.profile},
                    {"variant", ""},
                    {"seed", levels.seed},
                    {"repetition", levels.repetition}};
  record.id = levels.scenario + "_" + levels.profile + "_" + levels.seed + "_" + levels.repetition;
  record.status = status;
  return record;
}

/// Completed and passed, with the measure ego_driving_score.
inline evaluation::RunRecord recordWith(const Levels& levels, double score) {
  evaluation::RunRecord record = recordWithout(levels, "completed");
  record.verdict = record::Outcome::kPassed;
  record.attempts = 1;
  record.exit_code = 0;
  record.measures["ego_driving_score"] = score;
  return record;
}

}  // namespace cdiff::test

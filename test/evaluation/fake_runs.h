// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Planned runs that a script plays: the scenario's text says how each ends.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/file.h"
#include "evaluation/run_plan.h"

namespace cdiff::test {

/// Plays `cdiff run FILE --quiet --results FOLDER`: the scenario's text says how it ends.
inline constexpr const char* kFakeProgram = R"sh(#!/bin/sh
folder=$5
echo attempt >> $folder/attempts
succeed() {
  cat > $folder/summary.json <<EOF
{"status": "completed", "simulated_seconds": 4.0, "ego": {"driving_score": 80},
 "faults": [], "verdict": {"outcome": "passed", "reasons": []}}
EOF
  : > $folder/trace.csv
  exit 0
}
case "$(cat $2)" in
  good) succeed ;;
  hang) sleep 100 & echo $! > $folder/child; wait ;;
  dies) kill -9 $$ ;;
  dies_once) [ $(wc -l < $folder/attempts) -gt 1 ] && succeed; exit 137 ;;
  refuses) echo "cdiff: key 'x' is wrong" >&2; exit 3 ;;
  half) echo '{"status": "comp' > $folder/summary.json; exit 0 ;;
  polite) trap 'exit 130' INT; touch $folder/ready; while :; do sleep 0.05; done ;;
esac
)sh";

inline void writeFakeProgram(const std::filesystem::path& file) {
  std::ofstream(file) << kFakeProgram;
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

/// Runs with these texts; ids are the texts and their places.
inline std::vector<evaluation::PlannedRun> fakePlan(const std::vector<std::string>& ways) {
  std::vector<evaluation::PlannedRun> runs;
  for (const std::string& way : ways) {
    evaluation::PlannedRun run;
    run.id = way + std::to_string(runs.size());
    for (const std::string& factor : evaluation::factorNames()) run.factors[factor] = "x";
    run.scenario_text = way;
    run.scenario_sha256 = core::sha256(way);
    runs.push_back(run);
  }
  return runs;
}

}  // namespace cdiff::test

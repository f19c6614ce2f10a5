// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::evaluation {

/// What workers of any host need to run what a batch has planned, besides the record.json and
/// scenario.yaml of each run. It is the file plan.json of the result folder, and holds only runs
/// that had no result when it was written.
struct PlanFile {
  static constexpr const char* kName = "plan.json";

  std::string program;           ///< SHA-256 of program and libraries that planned
  std::string instruction_sets;  ///< of program and networks, on the machine that planned
  double timeout = 600.0;        ///< wall time of one attempt [s]
  int retries = 1;               ///< further attempts where a process or its simulator died
  bool fresh = false;            ///< the program starts afresh for each session
  std::vector<std::string> ids;  ///< of the runs, in their order
};

/// The instruction sets that decide the bytes of a session on this machine: "x86-64 baseline;
/// encoder with avx2, denoiser with avx2".
std::string instructionSets();

/// Writes the file whole. Throws InputError naming it.
void writePlan(const std::filesystem::path& results, const PlanFile& plan);

/// Throws InputError naming a file that is absent or no plan.
PlanFile readPlan(const std::filesystem::path& results);

/// Throws InputError that says what differs where this program or machine would give other bytes
/// than the one that planned.
void requireSameProgram(const PlanFile& plan);

}  // namespace cdiff::evaluation

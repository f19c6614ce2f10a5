// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// An evaluation: which sessions a batch runs, as one YAML file. Every list is a factor; the batch
/// is the product of all of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace cdiff::evaluation {

/// Routes of a Bench2Drive file, each a scenario of its own.
struct Bench2DriveOptions {
  std::string file;
  std::string networks;             ///< folder with TOWN.net.xml files
  std::vector<std::string> routes;  ///< ids; empty: all whose town's network is there

  void describe(core::OptionsVisitor& visitor);
};

/// An empty list leaves that factor as each scenario has it.
struct MatrixOptions {
  std::int64_t schema_version = 1;
  std::string name = "evaluation";
  std::vector<std::string> scenarios;  ///< shipped names or files
  std::string suite;                   ///< name or folder of a route suite; each route a scenario
  Bench2DriveOptions bench2drive;
  std::vector<std::string> ego_planners;
  std::vector<std::string> cbv_planners;
  std::vector<std::string> modes;
  std::vector<std::string> guidance_profiles;
  /// "ego_planner=NAME cbv_planner=NAME mode=MODE guidance_profile=NAME" each, any of the four:
  /// instead of the product of those lists.
  std::vector<std::string> combinations;
  std::vector<std::string> variants;  ///< "name: key=value key=value" each
  std::vector<std::string> seeds;     ///< whole numbers
  std::int64_t repetitions = 1;
  std::vector<std::string> set;  ///< "key=value" each, for every run
  double timeout = 600.0;        ///< wall time of one run [s]
  std::int64_t retries = 1;      ///< of a run whose simulator or process died

  void describe(core::OptionsVisitor& visitor);
};

/// Reads a matrix by file name or by the name of one in config/evaluations. Files in it are
/// resolved against its folder. Throws InputError naming file, line and key, or the nearest shipped
/// one.
MatrixOptions loadMatrix(const std::string& name_or_file);

/// Names of the shipped matrices, sorted.
std::vector<std::string> shippedMatrices();

/// The matrix as text without what may change between a batch and its resumption (time-out and
/// retries): equal texts plan the same runs.
std::string identityOf(const MatrixOptions& matrix);

}  // namespace cdiff::evaluation

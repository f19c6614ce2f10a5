// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/matrix.h"
#include "session/scenario_options.h"

namespace cdiff::evaluation {

// The runs of a matrix before they are run, and hashes of all that their measures depend on.

/// SHA-256 by name: "network", "demand", "storyboard", "route_file", "speed_target", "ego_weights",
/// "cbv_weights" (where the scenario has them) and "program".
using InputHashes = std::map<std::string, std::string>;

/// What a run's measures depend on besides its resolved scenario: the content of the files that the
/// scenario names, and the program. A finished run stays in a resumed batch only while all of it is
/// the same.
/// Hashes each file once.
class InputHasher {
 public:
  /// Throws InputError naming a file or model that cannot be read.
  InputHashes hashes(const session::ScenarioOptions& options);

 private:
  const std::string& ofFile(const std::filesystem::path& file, const std::string& what);
  /// Of an OpenSCENARIO file and its catalogs.
  const std::string& ofStoryboard(const std::string& file);
  const std::string& ofNetwork(const planning::PlannerDescriptor& planner,
                               const session::ScenarioOptions& options);
  std::map<std::string, std::string> files_;
  std::map<std::string, std::string> storyboards_;
  std::map<std::pair<std::string, std::string>, std::string> models_;  ///< by planner and model
};

/// SHA-256 of this program, of those of its libraries that are ours, and of its plug-ins. Package
/// version and revision would not distinguish a build with changed sources from the one before.
const std::string& programSha256();

/// Names of the inputs that differ, or are on one side only, joined by ", "; empty when none does.
/// Those in `others` do not count.
std::string changedInputs(const InputHashes& before, const InputHashes& now,
                          const std::set<std::string>& others = {});

// The runs of a matrix in a fixed order, each with its factors and its resolved scenario: wrong
// input is found here, before anything runs.

/// Level of every factor by name (see factorNames).
using Factors = std::map<std::string, std::string>;

/// "scenario", "ego_planner", "cbv_planner", "mode", "method", "guidance_profile", "variant",
/// "seed", "repetition".
const std::vector<std::string>& factorNames();

/// A level as part of a name: "cut_in" of the file "my/cut_in.yaml", any other as it is.
std::string levelName(const std::string& factor, const std::string& level);

/// What a process of a batch is asked to do.
struct RunCommand {
  /// Arguments of the program. One that begins with "{run}" has the folder of the run there, and
  /// one that begins with "{results}" that of the batch.
  std::vector<std::string> words = {"run",   "{run}/scenario.yaml", "--quiet", "--results",
                                    "{run}", "--overwrite"};
  /// File in the run's folder that it leaves; empty: what it leaves lies elsewhere.
  std::string result = "summary.json";

  /// Whether it runs a session whose summary is the run's result. Else the exit code 0 is all that
  /// is asked.
  bool isSession() const { return words.front() == "run"; }
  bool operator==(const RunCommand& other) const {
    return words == other.words && result == other.result;
  }
};

/// One run that is to come: of a session of a matrix, or of another command. It has its factors,
/// and the resolved scenario with hashes of its inputs.
struct PlannedRun {
  std::string id;  ///< name of its folder; made of the factors that vary
  Factors factors;
  std::string scenario_text;    ///< resolved, as YAML
  std::string scenario_sha256;  ///< SHA-256 of that text
  InputHashes inputs;           ///< hashes of what it depends on besides
  RunCommand command = {};
};

/// Scenarios outermost, repetitions innermost. `source` names the matrix in errors. Throws
/// InputError for an empty matrix, one of more than 100,000 runs, an unknown scenario, planner or
/// profile, a seed that is not a whole number, a variant that is not "name: key=value ...", and
/// everything a scenario can have wrong.
std::vector<PlannedRun> planRuns(const MatrixOptions& matrix, const std::string& source);

/// The same without the runs whose levels do not fit together (session::UnfitCombination). Throws
/// InputError where that leaves none. Into `left_out` goes a line for each reason.
std::vector<PlannedRun> planFittingRuns(const MatrixOptions& matrix, const std::string& source,
                                        std::vector<std::string>& left_out);

/// Part of a plan: of each factor that is named the levels that count.
using ChosenLevels = std::map<std::string, std::set<std::string>>;

/// From texts as "ego_planner=plant,diffusion". Throws InputError for anything else, for a factor
/// that is none and for a level that no run has.
ChosenLevels chosenLevels(const std::vector<std::string>& texts,
                          const std::vector<PlannedRun>& plan);

bool isChosen(const PlannedRun& run, const ChosenLevels& levels);

}  // namespace cdiff::evaluation

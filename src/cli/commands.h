// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "core/fork_server.h"
#include "core/program.h"

namespace cdiff::cli {

// The subcommands of `cdiff`: each adds itself to the program and sets the exit code when it runs.

using core::ExitCode;

void addRunCommand(CLI::App& program, int& exit_code);
void addDemoCommand(CLI::App& program, int& exit_code);
void addEvaluateCommand(CLI::App& program, int& exit_code);
void addExportCommand(CLI::App& program, int& exit_code);
void addNewCommand(CLI::App& program, int& exit_code);
void addValidateCommand(CLI::App& program, int& exit_code);
void addImportCommand(CLI::App& program, int& exit_code);
void addMetricCommand(CLI::App& program, int& exit_code);
void addTrainCommand(CLI::App& program, int& exit_code);
void addDoctorCommand(CLI::App& program, int& exit_code);
void addReportCommand(CLI::App& program, int& exit_code);
void addRealismCommand(CLI::App& program, int& exit_code);
void addSearchCommand(CLI::App& program, int& exit_code);
void addSuiteCommand(CLI::App& program, int& exit_code);
void addSteeringCommand(CLI::App& program, int& exit_code);
void addTuneCommand(CLI::App& program, int& exit_code);
void addWhatIfCommand(CLI::App& program, int& exit_code);
void addWorkerCommand(CLI::App& program, int& exit_code);
/// Runs the sessions of `cdiff evaluate`; not listed.
void addServeCommand(CLI::App& program, int& exit_code);
/// Where the program is built with ROS.
void addReplayCommand(CLI::App& program, int& exit_code);
void addCollectCommand(CLI::App& program, int& exit_code);

/// Sets up a session by the words of a `cdiff run` and gives what drives it, which answers the exit
/// code. Throws as that command does, and CLI::ParseError for words that it refuses.
core::ForkedRun prepareRun(const std::vector<std::string>& words);

/// Writes the page of a training, `training.html`, from the curves.csv and the model card of its
/// output folder, and returns where. Throws InputError when the folder holds no training.
std::filesystem::path writeTrainingPage(const std::filesystem::path& folder);

}  // namespace cdiff::cli

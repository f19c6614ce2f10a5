// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/slurm/slurm_queue.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/guarded_process.h"
#include "core/json_file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEngineFile = "engine.json";
constexpr const char* kPackage = "slurm-client";
constexpr double kPatience = 60.0;  // for one command [s]
constexpr std::size_t kMostOutput = std::size_t{1} << 20;

/// How a command of Slurm ended, and what it printed.
struct Answer {
  bool succeeded = false;
  std::string text;  ///< without the last line break
};

Answer ask(const std::string& command, const std::vector<std::string>& arguments) {
  const core::ProcessOutput output;
  core::GuardedProcess process(core::findProgram(command, kPackage), arguments, {},
                               {{}, -1, output.descriptor()});
  const bool ended = process.waitForEnd(kPatience, output);
  process.kill();
  std::string text = output.end(kMostOutput);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (!ended)
    text = output.isTooLong() ? "it prints without end"
                              : "no answer within " + core::formatNumber(kPatience) + " s";
  return {ended && process.exitCode() == 0, text};
}

/// Whether a line is the id of a job or of tasks of one ("12", "12_3", "12_[0-3%2]"), and none of
/// the words that sites and Slurm add.
bool isTaskId(const std::string& line) {
  return !line.empty() && std::isdigit(static_cast<unsigned char>(line.front())) != 0 &&
         line.find_first_not_of("0123456789_[]-,%") == std::string::npos;
}

Answer require(const std::string& command, const std::vector<std::string>& arguments) {
  Answer answer = ask(command, arguments);
  if (answer.succeeded) return answer;
  constexpr std::size_t kShown = 1000;
  throw core::InputError("Slurm refused " + command + ": " + answer.text.substr(0, kShown));
}

}  // namespace

std::size_t requireSlurm() {
  for (const char* command : {"sbatch", "squeue", "scancel", "scontrol"})
    core::findProgram(command, kPackage);
  for (const std::string& line :
       core::splitText(require("scontrol", {"show", "config"}).text, '\n')) {
    if (line.rfind("MaxArraySize", 0) != 0) continue;
    const std::string value = line.substr(line.find_last_of("= ") + 1);
    constexpr double kMost = 1e9;
    const auto size = core::parseNumber(value);
    if (size && *size >= 1.0 && *size <= kMost) return static_cast<std::size_t>(*size);
    throw core::InputError("this cluster allows no job arrays (MaxArraySize is " +
                           core::shortened(value) + ")");
  }
  throw core::InputError("scontrol show config names no MaxArraySize; is this Slurm?");
}

std::string submitJob(const std::vector<std::string>& arguments) {
  const std::string text = require("sbatch", arguments).text;
  const std::vector<std::string> lines = core::splitText(text, '\n');
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    const std::string id = line->substr(0, line->find(';'));
    if (!id.empty() && id.find_first_not_of("0123456789") == std::string::npos) return id;
  }
  throw core::InputError("sbatch gave no job id but '" + core::shortened(text) + "'");
}

std::optional<std::size_t> queuedTasks(const std::string& job_name) {
  const Answer answer =
      ask("squeue", {"--me", "--noheader", "--array", "--format=%i", "--name=" + job_name});
  if (!answer.succeeded) return std::nullopt;
  const std::vector<std::string> lines = core::splitText(answer.text, '\n');
  return static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), isTaskId));
}

void cancelJobs(const std::string& job_name) { require("scancel", {"--me", "--name=" + job_name}); }

void writeJobName(const fs::path& results, const std::string& job_name,
                  const std::vector<std::string>& ids) {
  const nlohmann::ordered_json json = {{"schema_version", 1},
                                       {"engine", "slurm"},
                                       {"results", fs::weakly_canonical(results).string()},
                                       {"job_name", job_name},
                                       {"jobs", ids}};
  core::writeOwnFile(results / kEngineFile, json.dump(2) + "\n");
}

namespace {

/// Throws json::exception for a file that is none of ours.
nlohmann::json engineIn(const fs::path& results) {
  return core::readJson(results / kEngineFile, "engine");
}

/// Whether the jobs work on another folder, of which this one is a copy.
bool isCopy(const nlohmann::json& engine, const fs::path& results) {
  const fs::path there = engine.value("results", results.string());
  std::error_code none;
  return fs::exists(there, none) && !fs::equivalent(there, results, none);
}

}  // namespace

bool hasJobName(const fs::path& results) {
  if (!core::isFile(results / kEngineFile)) return false;
  try {
    return !isCopy(engineIn(results), results);
  } catch (const nlohmann::json::exception&) {
    return true;  // readJobName() says what is wrong
  }
}

std::string readJobName(const fs::path& results) {
  const fs::path file = results / kEngineFile;
  if (!core::isFile(file)) {
    throw core::InputError("'" + results.string() + "' has no " + kEngineFile +
                           "; expected the results of a cdiff evaluate --engine slurm");
  }
  try {
    const nlohmann::json engine = engineIn(results);
    if (isCopy(engine, results))
      throw core::InputError("'" + results.string() + "' is a copy: its jobs work on '" +
                             engine.at("results").get<std::string>() + "'");
    return engine.at("job_name");
  } catch (const nlohmann::json::exception& error) {
    throw core::InputError("'" + file.string() + "' names no jobs: " + core::jsonFault(error) +
                           "; submit the batch again");
  }
}

}  // namespace cdiff::evaluation

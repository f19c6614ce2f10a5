// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff what_if`: a recorded session again, with another driver of the ego.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.h"
#include "core/csv.h"
#include "core/markup.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/intervals/intervals.h"
#include "record/result_folder.h"
#include "what_if/what_if.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using what_if::Answer;

struct WhatIfArguments {
  std::string result;
  std::optional<std::size_t> contact;
  std::optional<double> at;
  double before = 3.0;
  bool all = false;
  bool without_latest = false;
  what_if::DriverChoice driver;
};

/// Of one session: the question that was asked, or one for each contact.
std::vector<Answer> answersOf(const fs::path& folder, const WhatIfArguments& arguments,
                              const std::atomic<bool>& stop) {
  const what_if::RecordedRun run(folder);
  std::vector<what_if::Question> questions;
  if (arguments.all) {
    for (const what_if::RecordedContact& contact : run.contacts()) {
      const double before = std::min(arguments.before, contact.seconds);
      questions.push_back({contact, 0.0, before});
    }
  } else {
    questions.push_back(
        what_if::questionOf(run, arguments.contact, arguments.at, arguments.before));
  }
  std::vector<Answer> answers;
  if (questions.empty()) return answers;
  const session::SessionSetup setup(run.scenario());
  const what_if::Driver driver(setup, arguments.driver);
  for (what_if::Question& question : questions) {
    question.latest = !arguments.without_latest;
    answers.push_back(what_if::answer(run, setup, driver, question, stop));
    const fs::path page = what_if::writeAnswer(run, setup, answers.back());
    std::cout << what_if::answerText(answers.back()) << "\n  " << page.string() << "\n"
              << std::flush;
  }
  return answers;
}

/// "12 of 20 (60.0 % [36.1, 80.9])".
std::string shareText(std::size_t count, std::size_t all) {
  const evaluation::Interval interval = evaluation::binomialInterval(count, all);
  return std::to_string(count) + " of " + std::to_string(all) + " (" +
         core::formatFixed(100.0 * static_cast<double>(count) / static_cast<double>(all), 1) +
         " % [" + core::formatFixed(100.0 * interval.low, 1) + ", " +
         core::formatFixed(100.0 * interval.high, 1) + "])";
}

/// How many contacts the driver avoids.
std::string sharesText(const std::vector<Answer>& answers, const std::string& driver) {
  if (answers.empty()) return "no contact of the ego\n";
  const auto count = [&](const auto& avoided) {
    return shareText(
        static_cast<std::size_t>(std::count_if(answers.begin(), answers.end(), avoided)),
        answers.size());
  };
  const auto shifted = [](const Answer& answer) {
    return answer.open.avoids() && std::all_of(answer.shifted.begin(), answer.shifted.end(),
                                               [](const auto& shift) { return shift.second; });
  };
  return driver + " avoids, others answering to it: " +
         count([](const Answer& answer) { return answer.closed.avoids(); }) +
         "\n  others as recorded: " +
         count([](const Answer& answer) { return answer.open.avoids(); }) +
         "\n  ... also half a second earlier and later: " + count(shifted) + "\n";
}

/// Answers for each session of a batch, as rows of a table.
struct AnswerTable {
  std::string csv;
  std::vector<Answer> answers;
  std::size_t asked = 0;              ///< sessions
  int exit_code = ExitCode::kPassed;  ///< of sessions that could not be asked
};

void addSession(AnswerTable& table, const fs::path& folder, const WhatIfArguments& arguments,
                const std::atomic<bool>& stop) {
  for (Answer& answer : answersOf(folder, arguments, stop)) {
    std::vector<std::string> cells = what_if::answerCells(answer);
    cells.insert(cells.begin(), folder.filename().string());
    table.csv += core::csvRow(cells);
    table.answers.push_back(std::move(answer));
  }
  ++table.asked;
}

/// Sessions of a batch that cannot be repeated are named and left out.
void addSessionOrName(AnswerTable& table, const fs::path& folder, const WhatIfArguments& arguments,
                      const std::atomic<bool>& stop) {
  try {
    addSession(table, folder, arguments, stop);
  } catch (const core::Interrupted&) {
    throw;
  } catch (const core::Error& error) {
    std::cerr << "cdiff: " << core::plainText(error.what()) << "; this session is left out\n";
    const bool input = dynamic_cast<const InputError*>(&error) != nullptr;
    if (table.exit_code != ExitCode::kRunTimeError)
      table.exit_code = input ? ExitCode::kBadInput : ExitCode::kRunTimeError;
  }
}

int askAll(const WhatIfArguments& arguments) {
  const fs::path result = arguments.result;
  std::vector<std::string> head = what_if::answerHead();
  head.insert(head.begin(), "run");
  AnswerTable table{core::csvRow(head), {}};
  const std::vector<fs::path> folders = record::sessionFolders(result);
  const std::atomic<bool>& stop = core::catchStopSignals();
  for (const fs::path& folder : folders) {
    if (folders.size() == 1)
      addSession(table, folder, arguments, stop);
    else
      addSessionOrName(table, folder, arguments, stop);
  }
  if (table.asked == 0) return table.exit_code;  // and an earlier table stays
  const std::string label = arguments.driver.label();
  core::writeOwnFile(result / ("what_if_" + core::fileName(label) + ".csv"), table.csv);
  std::cout << sharesText(table.answers, label);
  return table.exit_code;
}

int whatIf(const WhatIfArguments& arguments) {
  if (arguments.all) return askAll(arguments);
  answersOf(arguments.result, arguments, core::catchStopSignals());
  return ExitCode::kPassed;
}

}  // namespace

void addWhatIfCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<WhatIfArguments>();
  CLI::App* command = program.add_subcommand(
      "what_if", "Run a recorded session again, with another driver of the ego from a time on");
  command
      ->add_option("result", arguments->result,
                   "Result folder of a session; with --all also of a batch")
      ->required();
  CLI::Option* contact = command->add_option("--contact", arguments->contact,
                                             "Contact of the ego that is to be avoided, from 1");
  CLI::Option* at = command->add_option("--at", arguments->at, "Time of the take-over [s]");
  CLI::Option* all = command->add_flag("--all", arguments->all, "All contacts of the ego");
  contact->excludes(at)->excludes(all);
  at->excludes(all);
  command->add_option("--before", arguments->before, "Take-over before the contact [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, what_if::kEarliest))
      ->excludes(at);
  command->add_flag("--without-latest", arguments->without_latest,
                    "Leave out the search for the latest take-over, which takes most of the time");
  command->add_option("--ego", arguments->driver.planner, "Planner that takes the ego over")
      ->capture_default_str();
  command
      ->add_option("--set", arguments->driver.set,
                   "Option of that planner as key=value; may be repeated")
      ->allow_extra_args(false);
  command->callback([arguments, &exit_code] { exit_code = whatIf(*arguments); });
}

}  // namespace cdiff::cli

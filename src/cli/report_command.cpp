// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff report`: pages and tables of evaluations and trainings that are there.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/batch_report.h"
#include "evaluation/comparison/comparison.h"
#include "evaluation/comparison/comparison_text.h"
#include "evaluation/dose_response.h"
#include "evaluation/matrix.h"
#include "evaluation/paper/findings.h"
#include "evaluation/pedal_use.h"
#include "evaluation/separation/ego_ranking.h"
#include "page/training_pages.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;

struct ReportArguments {
  std::string tables;
  std::string training;
  std::string pedals;
  std::string doses;
  std::string findings;
  std::vector<std::string> ego_ranking;
  std::vector<std::string> folders;
  std::vector<std::string> measures;
  std::string factor;
  std::string baseline;
  std::string csv;
  bool all = false;
};

/// Throws InputError for a folder that is not a batch; for a single session it names what to run
/// instead.
evaluation::RunSet readBatch(const std::string& folder) {
  if (core::isFile(fs::path(folder) / "session.yaml")) {
    throw InputError(
        "'" + folder +
        "' is the result of a single session; --compare pairs the runs of two batches by scenario "
        "and seed. Run both settings over the same scenarios and seeds (cdiff evaluate MATRIX "
        "--results DIR), one folder each or as levels of one factor in one folder; two sessions "
        "stand side by side in their report.html");
  }
  evaluation::RunSet set = evaluation::readRunSet(folder);
  const auto missing = std::count_if(set.records.begin(), set.records.end(),
                                     [](const auto& record) { return !record.complete(); });
  if (missing > 0)
    std::cerr << "'" << folder << "': " << missing << " of " << set.records.size()
              << " runs are not complete (not run, running still, or broken) and left out\n";
  return set;
}

std::vector<evaluation::Comparison> compare(const ReportArguments& arguments) {
  evaluation::checkMeasureNames(arguments.measures);
  const std::vector<std::string>& folders = arguments.folders;
  const bool levels = !arguments.factor.empty();
  if (levels != !arguments.baseline.empty()) {
    throw InputError(
        "--factor and --baseline go together, e.g. --factor guidance_profile "
        "--baseline none");
  }
  if (folders.size() != (levels ? 1U : 2U)) {
    throw InputError("--compare needs two result folders, or one with --factor and --baseline");
  }
  if (levels) {
    return evaluation::compareLevels(readBatch(folders[0]), arguments.factor, arguments.baseline,
                                     arguments.measures);
  }
  const evaluation::RunSet a = readBatch(folders[0]);
  const evaluation::RunSet b = readBatch(folders[1]);
  return {evaluation::compareRuns(a, b, evaluation::sharedFactors(a, b), arguments.measures)};
}

void requirePairs(const std::vector<evaluation::Comparison>& comparisons,
                  const ReportArguments& arguments) {
  for (const evaluation::Comparison& comparison : comparisons) {
    if (comparison.pairs > 0) return;
  }
  if (!arguments.factor.empty()) {
    throw InputError("'" + arguments.folders[0] + "' has no complete runs to pair: factor '" +
                     arguments.factor + "' needs a level beside the baseline '" +
                     arguments.baseline + "', with runs that agree in all other factors");
  }
  throw InputError("'" + arguments.folders[0] + "' and '" + arguments.folders[1] +
                   "' have no pair of complete runs with the same scenario, seed and repetition");
}

/// Tables, figures and page of a finished batch again, without running anything.
int makeTables(const ReportArguments& arguments) {
  const fs::path results = arguments.tables;
  const fs::path file = results / "matrix.yaml";
  if (!core::isFile(file)) {
    throw InputError("'" + results.string() +
                     "' is no result folder of `cdiff evaluate`: it has no matrix.yaml");
  }
  evaluation::MatrixOptions matrix;
  core::loadOptions({file.string(), core::readFile(file, "evaluation", core::kLargestOptionsFile)},
                    matrix);
  evaluation::writeBatchReport(results, matrix.name);
  if (matrix.ego_ranking) evaluation::writeEgoRanking({results}, matrix.name);
  std::cout << "tables, figures and page: " << (results / "index.html").string() << "\n";
  return ExitCode::kPassed;
}

/// How measures follow the doses of a batch's variants.
int printDoses(const ReportArguments& arguments) {
  if (arguments.measures.empty())
    throw InputError("--doses needs a measure, as --figure cbv_speed_mean_mps");
  const evaluation::RunSet runs = readBatch(arguments.doses);
  std::cout << evaluation::doseMarkdown(
      evaluation::doseResponses(runs.records, arguments.measures));
  return ExitCode::kPassed;
}

int printFindings(const ReportArguments& arguments) {
  std::cout << evaluation::findingsMarkdown(
      evaluation::findingsOf(evaluation::readBatchRuns(arguments.findings)));
  return ExitCode::kPassed;
}

int rankEgos(const ReportArguments& arguments) {
  const fs::path first = arguments.ego_ranking.front();
  std::cout << evaluation::writeEgoRanking(
                   {arguments.ego_ranking.begin(), arguments.ego_ranking.end()},
                   fs::weakly_canonical(first).filename().string())
            << "page: " << (first / "ego_ranking.html").string() << "\n";
  return ExitCode::kPassed;
}

int countPedals(const ReportArguments& arguments) {
  std::cout << evaluation::pedalMarkdown(evaluation::pedalCounts(arguments.pedals));
  return ExitCode::kPassed;
}

int drawTraining(const ReportArguments& arguments) {
  const fs::path page = writeTrainingPage(arguments.training);
  std::cout << "curves of the training: " << page.string() << "\n";
  return ExitCode::kPassed;
}

int printComparisons(const ReportArguments& arguments) {
  std::vector<evaluation::Comparison> comparisons = compare(arguments);
  requirePairs(comparisons, arguments);
  evaluation::adjustForNumber(comparisons);
  std::cout << evaluation::comparisonMarkdown(comparisons, arguments.all);
  const std::string csv = evaluation::comparisonCsv(comparisons);
  if (arguments.csv.empty()) {
    core::writeOwnFile(fs::path(arguments.folders.back()) / "compare.csv", csv);
  } else {
    core::writeFileAtomically(arguments.csv, csv);
  }
  return ExitCode::kPassed;
}

/// Whether options are given that only a comparison heeds; --figure also chooses doses.
bool narrowsComparison(const ReportArguments& arguments) {
  const bool figures = !arguments.measures.empty() && arguments.doses.empty();
  return !arguments.factor.empty() || !arguments.baseline.empty() || figures ||
         !arguments.csv.empty() || arguments.all;
}

int report(const ReportArguments& arguments) {
  struct Asked {
    bool given;
    const char* option;
    int (*answer)(const ReportArguments&);
  };
  const Asked options[] = {{!arguments.folders.empty(), "--compare A B", printComparisons},
                           {!arguments.doses.empty(), "--doses DIR", printDoses},
                           {!arguments.findings.empty(), "--findings DIR", printFindings},
                           {!arguments.tables.empty(), "--tables DIR", makeTables},
                           {!arguments.training.empty(), "--training DIR", drawTraining},
                           {!arguments.pedals.empty(), "--pedals DIR", countPedals},
                           {!arguments.ego_ranking.empty(), "--ego-ranking DIR", rankEgos}};
  std::vector<std::string> names;
  std::vector<const Asked*> asked;
  for (const Asked& option : options) {
    names.emplace_back(option.option);
    if (option.given) asked.push_back(&option);
  }
  if (asked.size() != 1) throw InputError("give one of " + core::joinText(names, ", "));
  if (arguments.folders.empty() && narrowsComparison(arguments))
    throw InputError("--factor, --baseline, --figure, --all and --csv belong to --compare");
  return asked.front()->answer(arguments);
}

}  // namespace

fs::path writeTrainingPage(const fs::path& folder) {
  const fs::path curves = folder / "curves.csv";
  if (!core::isFile(curves)) {
    throw InputError("'" + folder.string() +
                     "' is no output folder of `cdiff train`: it has no curves.csv");
  }
  const fs::path card = folder / "model_card.md";
  const auto stages =
      page::readTrainingCurves(core::readFile(curves, "training curves"), curves.string());
  const fs::path page = folder / "training.html";
  const std::string title = fs::weakly_canonical(folder).filename().string();
  core::writeOwnFile(
      page, page::trainingReport(title, stages,
                                 fs::exists(card) ? core::readFile(card, "model card") : ""));
  return page;
}

namespace {

/// What may be asked for, one at a time.
void addQuestions(CLI::App* command, const std::shared_ptr<ReportArguments>& arguments) {
  command
      ->add_option("--compare", arguments->folders,
                   "Result folders A and B of `cdiff evaluate`, or one with --factor")
      ->expected(1, 2);
  command->add_option("--doses", arguments->doses,
                      "Print how measures follow the doses of this result folder: the variants "
                      "AXIS_NUMBER, with rank correlations");
  command->add_option("--findings", arguments->findings,
                      "Print which findings of the paper this result folder of evaluation "
                      "paper_tables reproduces");
  command->add_option("--tables", arguments->tables,
                      "Write tables/, figures/ and index.html of this result folder again");
  command->add_option("--training", arguments->training,
                      "Draw the curves of this output folder of `cdiff train`, also while it runs");
  command->add_option("--pedals", arguments->pedals,
                      "Print which pedals CBVs were driven with, from the traces of this result "
                      "folder of `cdiff run` or `cdiff evaluate`");
  command
      ->add_option("--ego-ranking", arguments->ego_ranking,
                   "Rank the egos of these result folders of `cdiff evaluate`; also of folders "
                   "that hold a user's sessions. Writes ego_ranking.html into the first")
      ->expected(1, 100);
}

}  // namespace

void addReportCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = program.add_subcommand(
      "report",
      "Compare evaluations run by run; make their tables again; draw a training; count pedals; "
      "rank egos");
  addQuestions(command, arguments);
  command->add_option("--factor", arguments->factor, "Compare the levels of this factor");
  command->add_option("--baseline", arguments->baseline, "Level that the others are compared with");
  command->add_option("--figure", arguments->measures, "Only this measure; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--all", arguments->all,
                    "Also the measures beside the five headline ones, corrected among themselves");
  command->add_option("--csv", arguments->csv,
                      "CSV file (default: compare.csv in the last folder)");
  command->callback([arguments, &exit_code] { exit_code = report(*arguments); });
}

}  // namespace cdiff::cli

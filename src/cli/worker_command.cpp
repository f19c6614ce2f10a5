// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff worker`: runs what a batch has planned, on any host that sees its folder.
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "cli/worker_part.h"
#include "core/program.h"
#include "evaluation/plan_file.h"
#include "evaluation/worker.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

struct WorkerArguments {
  std::string results;
  std::string part;
  int jobs = 1;
  double expiry = core::LeaseTerms().expiry;
  bool wait = false;
};

int work(const WorkerArguments& arguments) {
  const fs::path results = fs::absolute(arguments.results);
  const evaluation::PlanFile plan = evaluation::readPlan(results);
  const auto ids = partOf(plan.ids, arguments.part);
  evaluation::requireSameProgram(plan);
  evaluation::WorkerOptions options;
  options.results = results;
  if (!plan.fresh) options.server = {"serve"};
  options.jobs = arguments.jobs;
  options.timeout = plan.timeout;
  options.retries = plan.retries;
  options.grace = 15.0;  // a cluster may kill soon after its first signal
  options.lease.program = "cdiff worker";
  options.lease.expiry = arguments.expiry;
  options.waits = arguments.wait;
  options.compares_inputs = true;
  bool refused = false;
  options.ended = [&](const evaluation::RunRecord& record) {
    refused = refused || (record.attempts == 0 && record.exit_code == ExitCode::kBadInput);
    std::cerr << record.id << " " << record.status
              << (record.cause.empty() ? "" : " (" + record.cause + ")") << "\n";
  };
  evaluation::runPlanned(ids, options, core::catchStopSignals());
  if (core::stopRequested()) return ExitCode::kReturned;
  return refused ? ExitCode::kBadInput : ExitCode::kPassed;
}

}  // namespace

void addWorkerCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<WorkerArguments>();
  CLI::App* command = program.add_subcommand(
      "worker", "Run what a batch has planned (--engine print), beside workers on other hosts");
  command->add_option("results", arguments->results, "Result folder of the batch, on a shared disk")
      ->required();
  command->add_option("--part", arguments->part,
                      "Only run I, I+N, I+2N ... of the plan, as I/N with I from 0 on");
  command->add_option("--jobs", arguments->jobs, "Sessions at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command
      ->add_option("--expiry", arguments->expiry,
                   "Time without a sign of a worker of another host after which its run is taken "
                   "over [s]")
      ->capture_default_str()
      ->check(CLI::Range(3.0 * core::LeaseTerms().beat, 86400.0));
  command->add_flag("--wait", arguments->wait,
                    "Wait for runs that other workers have, and take over what they leave behind");
  command->footer(
      "Exit codes: 0 nothing is left to do here, whatever the verdicts; 75 interrupted, and the "
      "run returned; 3 wrong input, another build, or a run whose files are not what was planned: "
      "the other runs went on.");
  command->callback([arguments, &exit_code] { exit_code = work(*arguments); });
}

}  // namespace cdiff::cli

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff metric`: one metric for the cases of a file, or the list of definitions.
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "record/metric_file.h"

namespace cdiff::cli {

void addMetricCommand(CLI::App& program, int& exit_code) {
  auto metric = std::make_shared<std::string>();
  auto file = std::make_shared<std::string>();
  CLI::App* command =
      program.add_subcommand("metric",
                             "Compute one metric for the cases of a file, one line each; or print "
                             "the definitions of all measures of a session");
  command->add_option("metric", *metric, "ttc_2d, shapiro_wilk, wasserstein or definitions")
      ->required()
      ->check(CLI::IsMember({"ttc_2d", "shapiro_wilk", "wasserstein", "definitions"}));
  command->add_option("file", *file, "Cases as CSV or JSON (not for definitions)");
  command->callback([metric, file, &exit_code] {
    exit_code = ExitCode::kPassed;
    if (*metric == "definitions") {
      if (!file->empty())
        throw core::InputError("metric definitions takes no file: '" + *file + "'");
      std::cout << metrics::measureList();
      return;
    }
    if (file->empty()) {
      throw core::InputError("metric " + *metric + " needs a file of cases: cdiff metric " +
                             *metric + " FILE");
    }
    for (const std::string& line : record::evaluateMetricFile(*metric, *file))
      std::cout << line << "\n";
  });
}

}  // namespace cdiff::cli

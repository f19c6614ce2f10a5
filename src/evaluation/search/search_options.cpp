// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/search/search_options.h"

#include <filesystem>

#include "core/file.h"

namespace cdiff::evaluation {
namespace {

std::filesystem::path searchFolder() { return core::shareFolder() / "config" / "search_spaces"; }

}  // namespace

void SearchOptions::describe(core::OptionsVisitor& visitor) {
  constexpr std::int64_t kMost = 100000;
  visitor.integer({"schema_version", "", "Version of this format."}, schema_version, 1, 1);
  visitor.list({"keys", "", "Keys of the scenario, each \"key: low .. high\" or \"key: a | b\"."},
               keys);
  visitor.list({"attack_keys", "", "Further keys in modes challenging and safety_critical."},
               attack_keys);
  visitor.text({"method", "", "New cases from the worst so far, or all at random."}, method,
               {"evolution", "random"});
  visitor.integer({"batch", "", "Cases that are proposed together."}, batch, 1, kMost);
  visitor.integer({"draws", "", "First cases, drawn at random."}, draws, 1, kMost);
  visitor.number({"fresh", "", "Share of later cases that are drawn at random."}, fresh, 0.0, 1.0);
  visitor.integer({"elite", "", "Worst cases so far, of which new ones are made."}, elite, 1,
                  kMost);
  visitor.number({"change", "", "Share of the keys that a new case changes."}, change, 0.0, 1.0);
  visitor.number({"step", "", "Standard deviation of a change, as a share of the range."}, step,
                 0.001, 1.0);
  visitor.number({"timeout", "s", "Wall time after which a session is killed."}, timeout, 0.1,
                 86400.0);
  visitor.integer({"retries", "", "Further attempts when a session's process or SUMO died."},
                  retries, 0, 100);
}

SearchOptions loadSearchOptions(const std::string& name_or_file) {
  const auto file = core::shippedOrFile(searchFolder(), name_or_file, "search space");
  SearchOptions options;
  core::loadOptions(
      {file.string(), core::readFile(file, "search space", core::kLargestOptionsFile)}, options);
  return options;
}

std::vector<std::string> shippedSearchOptions() { return core::shippedNames(searchFolder()); }

}  // namespace cdiff::evaluation

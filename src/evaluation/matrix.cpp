// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/matrix.h"

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using core::InputError;

fs::path matrixFolder() { return core::shareFolder() / "config" / "evaluations"; }

fs::path findMatrix(const std::string& name_or_file) {
  if (core::isFile(name_or_file)) return fs::absolute(name_or_file);
  const fs::path shipped = matrixFolder() / (name_or_file + ".yaml");
  if (core::isFile(shipped)) return shipped;
  const std::vector<std::string> known = shippedMatrices();
  throw InputError("evaluation '" + name_or_file +
                   "' is neither a file nor a shipped evaluation; the nearest shipped one is '" +
                   core::nearestName(name_or_file, known) +
                   "' (all: " + core::joinText(known, ", ") + ")");
}

bool isThere(const fs::path& path) { return core::isFile(path) || core::isFolder(path); }

/// A name stays when there is nothing of that name in the folder.
void resolveAgainst(const fs::path& folder, std::string& name) {
  if (name.empty() || fs::path(name).is_absolute() || !isThere(folder / name)) return;
  name = fs::weakly_canonical(folder / name).string();
}

}  // namespace

void Bench2DriveOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"file", "", "Bench2Drive route file; empty: none."}, file, {});
  visitor.text({"networks", "", "Folder with TOWN.net.xml files."}, networks, {});
  visitor.list({"routes", "", "Route ids; empty: all whose town's network is there."}, routes);
}

void MatrixOptions::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"schema_version", "", "Version of this file format."}, schema_version, 1, 1);
  visitor.text({"name", "", "Name of the evaluation in results."}, name, {});
  visitor.list({"scenarios", "", "Shipped scenarios or scenario files."}, scenarios);
  visitor.text({"suite", "", "Shipped route suite or folder of one; each route a scenario."}, suite,
               {});
  visitor.group({"bench2drive", "", "Bench2Drive routes, each a scenario of its own."},
                bench2drive);
  visitor.list({"ego_planners", "", "Planners of the ego; empty: the scenario's."}, ego_planners);
  visitor.list({"cbv_planners", "", "Planners of the CBVs; empty: the scenario's."}, cbv_planners);
  visitor.list({"modes", "", "naturalistic, safety_critical; empty: the scenario's."}, modes);
  visitor.list(
      {"guidance_profiles", "", "Of the CBVs: shipped profiles or files; empty: that of the mode."},
      guidance_profiles);
  visitor.list({"combinations", "",
                "Instead of the product of the four lists above: sets of their levels, each "
                "\"ego_planner=NAME cbv_planner=NAME mode=MODE guidance_profile=NAME\" or a part "
                "of it."},
               combinations);
  visitor.list({"variants", "", "Sets of overrides, each \"name: key=value key=value\"."},
               variants);
  visitor.list({"seeds", "", "Root seeds; empty: the scenario's."}, seeds);
  visitor.integer({"repetitions", "", "Runs of the same seed."}, repetitions, 1, 1000);
  visitor.list({"set", "", "Overrides for every run, each key=value."}, set);
  visitor.number({"timeout", "s", "Wall time after which a run is killed."}, timeout, 0.1, 86400.0);
  visitor.integer({"retries", "", "Further attempts when a run's process or SUMO died."}, retries,
                  0, 100);
}

MatrixOptions loadMatrix(const std::string& name_or_file) {
  const fs::path file = findMatrix(name_or_file);
  MatrixOptions matrix;
  matrix.name = file.stem().string();
  core::loadOptions({file.string(), core::readFile(file, "evaluation")}, matrix);
  const fs::path folder = file.parent_path();
  for (std::string& scenario : matrix.scenarios) resolveAgainst(folder, scenario);
  for (std::string& profile : matrix.guidance_profiles) resolveAgainst(folder, profile);
  if (core::isFile(folder / matrix.suite / "suite.yaml")) resolveAgainst(folder, matrix.suite);
  resolveAgainst(folder, matrix.bench2drive.file);
  resolveAgainst(folder, matrix.bench2drive.networks);
  return matrix;
}

std::vector<std::string> shippedMatrices() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(matrixFolder())) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string identityOf(const MatrixOptions& matrix) {
  const MatrixOptions defaults;
  MatrixOptions same = matrix;
  same.timeout = defaults.timeout;
  same.retries = defaults.retries;
  return core::dumpOptions(same);
}

}  // namespace cdiff::evaluation

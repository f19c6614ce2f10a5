// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/suite_selection.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "core/clock.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/bench2drive_file.h"
#include "suite/seal.h"
#include "suite/suite.h"

namespace cdiff::evaluation {

namespace {

namespace fs = std::filesystem;
using core::InputError;

/// What `routes:` names: all routes, or these.
struct Wish {
  std::set<std::string> ids;    ///< those of dev10 too
  std::set<std::string> named;  ///< one by one; each must be there

  explicit Wish(const std::vector<std::string>& routes) {
    for (const std::string& route : routes) {
      if (route == kDev10) {
        ids.insert(dev10Routes().begin(), dev10Routes().end());
      } else {
        ids.insert(route);
        named.insert(route);
      }
    }
  }
  bool has(const std::string& id) const { return ids.empty() || ids.count(id) != 0; }
};

void requireAll(std::set<std::string> named, const Bench2DriveSelection& selection,
                const Bench2DriveOptions& options) {
  for (const auto& [id, network] : selection.routes) named.erase(id);
  for (const auto& [id, kept] : selection.repeated) named.erase(id);
  if (!named.empty()) {
    throw InputError("routes " + core::joinText({named.begin(), named.end()}, ", ") +
                     " are not in '" + options.file +
                     "', or the network of their town is not in '" + options.networks + "'");
  }
  if (selection.routes.empty()) {
    throw InputError("no route of '" + options.file +
                     "' lies in a town whose TOWN.net.xml is in '" + options.networks + "'");
  }
}

}  // namespace

const std::vector<std::string>& dev10Routes() {
  static const std::vector<std::string> routes = {"17569", "2091",  "25378", "25381", "25424",
                                                  "26405", "27494", "28198", "3255",  "3514"};
  return routes;
}

Bench2DriveSelection selectBench2Drive(const Bench2DriveOptions& options) {
  const map::Bench2DriveFile file(options.file);
  const auto repeated = file.repeatedRoutes();
  const Wish wish(options.routes);
  Bench2DriveSelection selection;
  for (const map::Bench2DriveEntry& entry : file.entries()) {
    const fs::path network = fs::path(options.networks) / (entry.town + ".net.xml");
    if (!wish.has(entry.id) || !core::isFile(network)) continue;
    const auto twin = repeated.find(entry.id);
    if (twin != repeated.end() && wish.has(twin->second)) {
      selection.repeated.insert(*twin);
    } else {
      selection.routes.emplace_back(entry.id, network.string());
    }
  }
  requireAll(wish.named, selection, options);
  return selection;
}

std::string repeatedText(const Bench2DriveSelection& selection) {
  if (selection.repeated.empty()) return "";
  std::vector<std::string> texts;
  for (const auto& [id, kept] : selection.repeated) texts.push_back(id + " (as " + kept + ")");
  return "left out, the path is that of another route: " + core::joinText(texts, ", ") + "; " +
         std::to_string(selection.routes.size()) + " of " +
         std::to_string(selection.routes.size() + selection.repeated.size()) + " routes are run\n";
}

std::string suiteName(const std::string& name_or_folder) {
  const std::filesystem::path path = std::filesystem::path(name_or_folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

namespace {

namespace fs = std::filesystem;
using core::InputError;

/// Folders of sealed suites by their names.
std::map<std::string, fs::path> sealedFolders(const MatrixOptions& matrix) {
  std::map<std::string, fs::path> folders;
  if (!matrix.suite.empty()) {
    const suite::Suite suite = suite::loadSuite(matrix.suite);
    if (suite.sealed) folders[suite.name] = suite.folder;
  }
  for (const std::string& scenario : matrix.scenarios) {
    const auto folder = suite::sealedSuiteOf(scenario);
    if (folder) folders[suite::loadSuite(folder->string()).name] = *folder;
  }
  return folders;
}

std::string timeText() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

std::vector<std::string> sealedSuitesOf(const MatrixOptions& matrix) {
  std::vector<std::string> names;
  for (const auto& [name, folder] : sealedFolders(matrix)) names.push_back(name);
  return names;
}

void requireOpeningReason(const MatrixOptions& matrix, const std::string& source) {
  const std::vector<std::string> names = sealedSuitesOf(matrix);
  if (names.empty() == matrix.open_sealed.empty()) return;
  if (names.empty()) {
    throw InputError(source + ": key 'open_sealed' gives a reason, but no sealed suite is run; " +
                     "remove it");
  }
  throw InputError(
      source + ": the suite " + core::joinText(names, ", ") +
      " is sealed: nothing may be chosen on it, and every opening is recorded; if that "
      "is what you want, say why: --open-sealed \"REASON\" (key 'open_sealed')");
}

std::string recordOpening(const MatrixOptions& matrix, const fs::path& results) {
  std::string lines;
  for (const auto& [name, folder] : sealedFolders(matrix)) {
    const std::string seal = core::sha256(core::readFile(folder / suite::kSealFile, "seal"));
    lines += timeText() + "  " + name + "  seal " + seal + "  matrix " + matrix.name + "  " +
             matrix.open_sealed + "\n";
  }
  if (lines.empty()) return "";
  const fs::path file = core::OutputFolder(results).claim("opened.log");
  std::ofstream log(file, std::ios::app);
  log << lines << std::flush;
  if (!log) throw InputError("cannot write '" + file.string() + "'");
  return "sealed suite opened:\n" + lines +
         "add this to docs/sealed_suites.md with who opened it; choose nothing on what you see\n";
}

}  // namespace cdiff::evaluation

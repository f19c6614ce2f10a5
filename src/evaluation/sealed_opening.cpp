// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/sealed_opening.h"

#include <ctime>
#include <fstream>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "suite/seal.h"
#include "suite/suite.h"

namespace cdiff::evaluation {
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
  const fs::path file = results / "opened.log";
  std::ofstream log(file, std::ios::app);
  log << lines << std::flush;
  if (!log) throw InputError("cannot write '" + file.string() + "'");
  return "sealed suite opened:\n" + lines +
         "add this to docs/sealed_suites.md with who opened it; choose nothing on what you see\n";
}

}  // namespace cdiff::evaluation

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_link.h"

#include <algorithm>
#include <fstream>

#include "core/file.h"
#include "core/markup.h"
#include "core/text.h"

namespace cdiff::simulation {

namespace fs = std::filesystem;

namespace {

constexpr std::streamoff kMostLogText = 1 << 14;  // [bytes] of a log that are read
constexpr std::size_t kMostLetters = 500;         // of a line that is quoted

/// The lines of SUMO's log in its first bytes, or in its last ones.
std::vector<std::string> linesOf(const fs::path& path, bool at_end) {
  if (!core::isFile(path)) return {};
  std::ifstream file(path, std::ios::binary);
  if (at_end) {
    file.seekg(0, std::ios::end);
    file.seekg(std::max<std::streamoff>(0, file.tellg() - kMostLogText));
  }
  std::string text(static_cast<std::size_t>(kMostLogText), '\0');
  file.read(text.data(), kMostLogText);
  text.resize(static_cast<std::size_t>(file.gcount()));
  return core::splitText(text, '\n');
}

}  // namespace

std::string sentenceAfter(const std::string& mark, const fs::path& log) {
  std::string sentence;
  for (const std::string& line : linesOf(log, false)) {
    const std::size_t at = line.find(mark);
    if (!sentence.empty() && line.front() != ' ') break;
    if (!sentence.empty()) sentence += line;
    if (sentence.empty() && at != std::string::npos) sentence = line.substr(at + mark.size());
  }
  return core::cutText(sentence, kMostLetters);
}

std::string lastLines(const fs::path& log) {
  constexpr std::size_t kLines = 4;
  std::vector<std::string> lines = linesOf(log, true);
  if (lines.size() > kLines) lines.erase(lines.begin(), lines.end() - kLines);
  for (std::string& line : lines) line = core::cutText(line, kMostLetters);
  return core::joinText(lines, " | ");
}

LogFolder::LogFolder(const fs::path& wanted) : path_(wanted) {
  if (wanted.empty()) {
    scratch_ = std::make_unique<core::ScratchFolder>();
    path_ = scratch_->path();
    return;
  }
  std::error_code error;
  fs::create_directories(path_, error);
  if (error)
    throw core::InputError("folder for SUMO's log '" + path_.string() + "': " + error.message());
}

bool SumoLink::attempt(const std::function<void()>& call) {
  try {
    call();
    return true;
  } catch (const libsumo::TraCIException&) {
    return false;
  }
}

void SumoLink::fail(const std::string& what) {
  try {
    throw;
  } catch (const core::Error&) {
    throw;
  } catch (const libsumo::TraCIException& refusal) {
    throw core::SimulatorError("SUMO refused (" + what + "): " + refusal.what());
  } catch (const std::exception& loss) {
    throw core::SimulatorError(lossText(what, loss.what()));
  }
}

}  // namespace cdiff::simulation

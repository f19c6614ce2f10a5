// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/import/netconvert.h"

#include <cstdlib>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/process.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {
namespace {

double netconvertLimit() {
  const char* given = std::getenv(kNetconvertLimitVariable);
  if (given == nullptr) return kNetconvertLimit;
  const auto seconds = core::parseNumber(given);
  if (seconds && *seconds > 0.0) return *seconds;
  throw core::InputError(std::string(kNetconvertLimitVariable) + " is '" + given +
                         "'; expected seconds above 0");
}

}  // namespace

void runNetconvert(const std::vector<std::string>& arguments, const std::string& subject) {
  constexpr double kStopPeriod = 0.1;  // [s]
  const double limit = netconvertLimit();
  const core::ProcessOutput output;
  core::GuardedProcess process(core::findProgram("netconvert", "sumo"), arguments,
                               core::environmentWith("SUMO_HOME", core::sumoHome().string()),
                               core::ProcessStreams{{}, -1, output.descriptor()});
  process.setDeadline(limit);
  while (!process.waitForEnd(kStopPeriod)) {
    if (core::stopRequested()) throw core::Interrupted("interrupted while netconvert ran");
  }
  if (process.deadlineMissed()) {
    throw core::InputError(subject + ": netconvert did not end within " +
                           core::formatNumber(limit) + " s and was ended; set " +
                           kNetconvertLimitVariable + " to more seconds if the network needs them");
  }
  if (process.endSignal() != 0)
    throw core::InputError(subject + ": netconvert crashed: " + process.endText() + ": " +
                           output.end());
  if (process.exitCode() == 0) return;
  throw core::InputError(subject + ": netconvert could not convert it (" + process.endText() +
                         "): " + output.end());
}

namespace {

namespace fs = std::filesystem;

/// netconvert's opening comment holds the date and paths.
std::string withoutGeneratedComment(std::string text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end != std::string::npos) text.erase(begin, end + 3 - begin);
  return text;
}

/// `format` is netconvert's option for the source, `types` the type map that goes with it.
std::string convert(const fs::path& source, const std::string& format, const std::string& types,
                    const std::vector<std::string>& options) {
  const core::ScratchFolder scratch;
  const fs::path converted = scratch.path() / "converted.net.xml";
  const fs::path type_map = core::shareFolder() / "sumo" / "data" / "typemap" / types;
  std::vector<std::string> arguments = {format,
                                        source.string(),
                                        "--type-files",
                                        type_map.string(),
                                        "--output-file",
                                        converted.string(),
                                        "--no-turnarounds.except-deadend",
                                        "true",
                                        "--xml-validation",
                                        "never"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const std::string subject = "network '" + source.string() + "'";
  runNetconvert(arguments, subject);
  if (!fs::exists(converted)) throw core::InputError(subject + ": netconvert wrote no network");
  return withoutGeneratedComment(core::readFile(converted, "converted network"));
}

}  // namespace

std::string convertOpenDrive(const fs::path& source) {
  return convert(source, "--opendrive-files", "opendriveNetconvert.typ.xml",
                 {"--opendrive.curve-resolution", "1", "--opendrive.min-width", "0"});
}

std::string convertOpenStreetMap(const fs::path& source) {
  return convert(
      source, "--osm-files", "osmNetconvert.typ.xml",
      {"--geometry.remove", "true", "--roundabouts.guess", "true", "--ramps.guess", "true",
       "--junctions.join", "true", "--tls.discard-simple", "true", "--tls.join", "true",
       "--remove-edges.isolated", "true", "--keep-edges.by-vclass", "passenger"});
}

}  // namespace cdiff::map

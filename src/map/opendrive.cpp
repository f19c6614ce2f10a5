// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "opendrive.h"

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/output_folder.h"
#include "e2e_cdiff/map/process.h"

namespace cdiff::map {
namespace {

namespace fs = std::filesystem;

/// Lane types of OpenDRIVE that vehicles drive on; others (sidewalk, shoulder, border ...) are left
/// out. Given here because Debian's netconvert comes without a type map and imports no lane then.
std::string laneTypes() {
  constexpr const char* kDriven =
      " speed=\"13.89\" disallow=\"pedestrian tram rail_urban rail rail_electric rail_fast "
      "ship\"/>\n";
  constexpr const char* kSlow =
      " speed=\"1.39\" disallow=\"pedestrian tram rail_urban rail rail_electric rail_fast "
      "ship\"/>\n";
  std::string text = "<types>\n";
  for (const char* id : {"driving", "entry", "exit", "onRamp", "offRamp", "connectingRamp",
                         "slipLane", "mwyEntry", "mwyExit"}) {
    text += std::string("  <type id=\"") + id + "\" priority=\"1\"" + kDriven;
  }
  text += std::string("  <type id=\"bidirectional\" priority=\"1\"") + kSlow;
  text += "  <type id=\"parking\" priority=\"1\" speed=\"1.39\" allow=\"emergency authority\"/>\n";
  text += "  <type id=\"bus\" priority=\"1\" speed=\"13.89\" allow=\"bus coach\"/>\n";
  text += "  <type id=\"taxi\" priority=\"1\" speed=\"13.89\" allow=\"taxi\"/>\n";
  text += "  <type id=\"HOV\" priority=\"1\" speed=\"13.89\" allow=\"hov\"/>\n";
  return text + "</types>\n";
}

/// netconvert's opening comment holds the date and paths.
std::string withoutGeneratedComment(std::string text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end != std::string::npos) text.erase(begin, end + 3 - begin);
  return text;
}

}  // namespace

std::string convertOpenDrive(const fs::path& source) {
  const core::ScratchFolder scratch;
  const fs::path types = scratch.path() / "types.typ.xml";
  const fs::path converted = scratch.path() / "converted.net.xml";
  core::writeFileAtomically(types, laneTypes());
  const std::string subject = "network '" + source.string() + "'";
  runNetconvert(
      {"--opendrive-files", source.string(), "--type-files", types.string(), "--output-file",
       converted.string(), "--opendrive.curve-resolution", "1", "--opendrive.min-width", "0",
       "--no-turnarounds.except-deadend", "true", "--xml-validation", "never"},
      subject);
  if (!fs::exists(converted)) throw core::InputError(subject + ": netconvert wrote no network");
  return withoutGeneratedComment(core::readFile(converted, "converted network"));
}

}  // namespace cdiff::map

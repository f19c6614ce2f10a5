// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "opendrive.h"

#include <unistd.h>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
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

/// A file that goes away with the object.
class ScratchFile {
 public:
  ScratchFile(const fs::path& scratch, const std::string& ending)
      : path_(scratch.string() + "." + std::to_string(::getpid()) + ending) {}
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// netconvert's opening comment holds the date and paths.
std::string withoutGeneratedComment(std::string text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end != std::string::npos) text.erase(begin, end + 3 - begin);
  return text;
}

}  // namespace

std::string convertOpenDrive(const fs::path& source, const fs::path& scratch) {
  const ScratchFile types(scratch, ".typ.xml");
  const ScratchFile converted(scratch, ".converting.net.xml");
  core::writeFileAtomically(types.path(), laneTypes());
  const ProcessResult result =
      runProcess({"netconvert", "--opendrive-files", source.string(), "--type-files",
                  types.path().string(), "--output-file", converted.path().string(),
                  "--opendrive.curve-resolution", "1", "--opendrive.min-width", "0",
                  "--no-turnarounds.except-deadend", "true", "--xml-validation", "never"});
  if (result.exit_code != 0 || !fs::exists(converted.path())) {
    throw core::InputError("netconvert could not convert '" + source.string() + "' (exit code " +
                           std::to_string(result.exit_code) + "): " + result.output);
  }
  return withoutGeneratedComment(core::readFile(converted.path(), "converted network"));
}

}  // namespace cdiff::map

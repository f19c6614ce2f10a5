// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/import/network_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <pugixml.hpp>
#include <string_view>

#include "core/checked_cache.h"
#include "core/file.h"
#include "core/guarded_process.h"
#include "core/markup.h"
#include "core/program.h"
#include "core/scratch_folder.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/import/road_type_speeds.h"
#include "map/import/vehicle_classes.h"

namespace cdiff::map {
namespace {

namespace fs = std::filesystem;

/// Wall time that netconvert may take [s]: kNetconvertLimit, or what the environment says.
double netconvertLimit() {
  const char* given = std::getenv(kNetconvertLimitVariable);
  if (given == nullptr) return kNetconvertLimit;
  const auto seconds = core::parseNumber(given);
  if (seconds && *seconds > 0.0) return *seconds;
  throw core::InputError(std::string(kNetconvertLimitVariable) + " is '" + given +
                         "'; expected seconds above 0");
}

/// How errors name a file that is converted.
std::string subjectOf(const fs::path& source) { return "network '" + source.string() + "'"; }

/// netconvert's opening comment holds the date and paths.
std::string withoutGeneratedComment(std::string text) {
  const std::size_t begin = text.find("<!-- generated on");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find("-->", begin);
  if (end != std::string::npos) text.erase(begin, end + 3 - begin);
  return text;
}

/// The file under a name that netconvert takes as it is: it splits names at commas and replaces
/// ${NAME} by a variable of the environment.
fs::path plainlyNamed(const fs::path& source, const core::ScratchFolder& scratch) {
  const std::string name = source.string();
  if (name.find(',') == std::string::npos && name.find("${") == std::string::npos) return source;
  const fs::path plain = scratch.path() / "source";
  fs::create_symlink(fs::absolute(source), plain);
  return plain;
}

/// Text of the SUMO network that netconvert makes of a file; `format` is its option for the file,
/// `types` the file of the type map that goes with it. `subject` names in errors what is converted.
std::string convert(const fs::path& file, const std::string& subject, const std::string& format,
                    const std::string& types, const std::vector<std::string>& options) {
  const core::ScratchFolder scratch;
  const fs::path converted = scratch.path() / "converted.net.xml";
  const fs::path type_map = core::shareFolder() / "sumo" / "data" / "typemap" / types;
  std::vector<std::string> arguments = {format,
                                        plainlyNamed(file, scratch).string(),
                                        "--type-files",
                                        type_map.string(),
                                        "--output-file",
                                        converted.string(),
                                        "--no-turnarounds.except-deadend",
                                        "true",
                                        "--xml-validation",
                                        "never"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  runNetconvert(arguments, subject);
  if (!fs::exists(converted)) throw core::InputError(subject + ": netconvert wrote no network");
  return withoutGeneratedComment(core::readFile(converted, "converted network"));
}

/// Whether this package wrote an OpenDRIVE file. One that is no XML is left to netconvert.
bool isOurOpenDrive(const fs::path& source) {
  pugi::xml_document document;
  if (!document.load_file(source.c_str(), pugi::parse_minimal)) return false;
  const pugi::xml_node header = document.child("OpenDRIVE").child("header");
  return std::string_view(header.attribute("vendor").value()) == kOpenDriveVendor;
}

/// Part of the cache key: raise the number when the importer gives another result for the same
/// input.
constexpr const char* kImporterVersion = "e2e_cdiff network importer 3";

std::vector<std::string> shippedNames(const fs::path& folder) {
  std::vector<std::string> names;
  if (!core::isFolder(folder)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (fs::exists(entry.path() / (name + ".net.xml"))) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path cachedFile(const std::string& content) {
  return core::cacheFile("networks", content + "\n" + kImporterVersion, ".net.xml");
}

void storeUnlessThere(const fs::path& file, const std::string& text) {
  if (core::cachedContent(file) != text) core::storeInCache(file, text);
}

/// Whether `tag` ("<osm") starts the first element, behind declarations and comments.
bool startsWithElement(std::string_view content, std::string_view tag) {
  for (std::size_t at = content.find('<'); at != std::string_view::npos;
       at = content.find('<', at + 1)) {
    if (content.compare(at, 4, "<!--") == 0) {
      at = content.find("-->", at);
      if (at == std::string_view::npos) return false;
      continue;
    }
    if (content.compare(at, 2, "<?") == 0 || content.compare(at, 2, "<!") == 0) continue;
    return content.compare(at, tag.size(), tag) == 0;
  }
  return false;
}

bool isOpenDrive(const std::string& source, const std::string& content) {
  return core::endsWith(source, ".xodr") || startsWithElement(content, "<OpenDRIVE");
}

bool isOpenStreetMap(const std::string& source, const std::string& content) {
  return core::endsWith(source, ".osm") || core::endsWith(source, ".osm.xml") ||
         startsWithElement(content, "<osm");
}

/// A file format that netconvert converts.
struct Format {
  const char* name;     ///< for messages
  const char* element;  ///< start of its root element's tag
  std::string (*convert)(const fs::path& source);
};

/// Attributes that place a road or a node.
bool isPlace(std::string_view attribute) {
  constexpr std::array<std::string_view, 16> kPlaces = {
      "s", "t", "x", "y",         "z",         "hdg",     "length", "a",
      "b", "c", "d", "curvature", "curvStart", "curvEnd", "lat",    "lon"};
  return std::find(kPlaces.begin(), kPlaces.end(), attribute) != kPlaces.end();
}

/// Counts the levels of elements below a document, and finds the first number that is none.
struct ElementWalker : pugi::xml_tree_walker {
  static constexpr std::size_t kMostLetters = 40;
  int levels = 0;
  std::string no_number;
  bool for_each(pugi::xml_node& node) override {
    levels = std::max(levels, depth() + 1);
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      if (isPlace(attribute.name()) && !std::isfinite(attribute.as_double()))
        no_number = "'" + core::cutText(attribute.value(), kMostLetters) + "' for '" +
                    attribute.name() + "' of <" + core::cutText(node.name(), kMostLetters) + ">";
    }
    return no_number.empty();
  }
};

/// netconvert's time grows with the square of the levels, and it builds roads on "nan". A text that
/// is no XML is left to it.
void requireConvertible(const std::string& content, const std::string& source) {
  constexpr int kMostLevels = 100;  // standard files have about ten
  pugi::xml_document document;
  if (!document.load_buffer(content.data(), content.size(), pugi::parse_minimal)) return;
  ElementWalker walker;
  document.traverse(walker);
  if (!walker.no_number.empty())
    throw core::InputError("network '" + source + "' has " + walker.no_number +
                           "; a finite number was expected");
  if (walker.levels <= kMostLevels) return;
  throw core::InputError("network '" + source + "' nests elements " +
                         std::to_string(walker.levels) + " levels deep; at most " +
                         std::to_string(kMostLevels) + " were expected");
}

void importConverted(const Format& format, const std::string& content, ImportedNetwork& network) {
  if (content.find(format.element) == std::string::npos) {
    throw core::InputError("network '" + network.source.string() + "': no " + format.element +
                           "> element; an " + format.name + " file was expected");
  }
  if (content.find("<!DOCTYPE") != std::string::npos) {
    throw core::InputError("network '" + network.source.string() +
                           "' holds <!DOCTYPE>, for which netconvert would read further files; "
                           "delete it");
  }
  network.file = cachedFile(content);
  if (auto text = core::checkedContent(network.file)) {
    network.text = std::move(*text);
  } else {
    requireConvertible(content, network.source.string());
    network.text = format.convert(network.source);
    core::storeChecked(network.file, network.text);
  }
  network.changes.push_back(std::string("converted from ") + format.name + " with netconvert");
}

void importSumoNetwork(const std::string& content, ImportedNetwork& network) {
  if (content.size() > 1 && content[0] == '\x1f' && content[1] == '\x8b') {
    throw core::InputError("network '" + network.source.string() +
                           "' is compressed; unpack it with gunzip first");
  }
  if (content.find("<net") == std::string::npos) {
    throw core::InputError("network '" + network.source.string() +
                           "': no <net> element; a SUMO network (*.net.xml), OpenDRIVE (*.xodr) or "
                           "OpenStreetMap (*.osm) was expected");
  }
  PermissionRewrite rewrite = dropUnknownClasses(content);
  network.text = std::move(rewrite.text);
  network.file = network.source;
  if (rewrite.removed.empty()) return;
  network.file = cachedFile(content);
  storeUnlessThere(network.file, network.text);
  network.changes.push_back("removed the vehicle classes " + core::joinText(rewrite.removed, " ") +
                            " from " + std::to_string(rewrite.attributes) +
                            " attributes: SUMO 1.15 does not know them");
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
  while (!process.waitForEnd(kStopPeriod, output)) {
    if (output.isTooLong())
      throw core::InputError(subject + ": netconvert prints without end: " + output.end());
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

std::string convertOpenDrive(const fs::path& source) {
  const core::ScratchFolder scratch;
  fs::path file = source;
  if (const auto completed = withSpeedsOfRoadTypes(core::readFile(source, "network"))) {
    file = scratch.path() / "completed.xodr";
    core::writeFileAtomically(file, *completed);
  }
  return convert(file, subjectOf(source), "--opendrive-files", "opendriveNetconvert.typ.xml",
                 {"--opendrive.curve-resolution", "1", "--opendrive.min-width", "0",
                  "--offset.disable-normalization", isOurOpenDrive(source) ? "true" : "false"});
}

namespace {

/// netconvert's words where nothing of a map is left.
bool saysNoRoads(const std::string& text) {
  return text.find("No nodes loaded") != std::string::npos ||
         text.find("No edges loaded") != std::string::npos;
}

[[noreturn]] void failWithoutRoads(const fs::path& source) {
  throw core::InputError("network '" + source.string() +
                         "': holds no road for cars; expected a part of a map with streets that "
                         "cars may use and that are connected");
}

}  // namespace

std::string convertOpenStreetMap(const fs::path& source) {
  try {
    std::string text =
        convert(source, subjectOf(source), "--osm-files", "osmNetconvert.typ.xml",
                {"--geometry.remove", "true", "--roundabouts.guess", "true", "--ramps.guess",
                 "true", "--junctions.join", "true", "--tls.discard-simple", "true", "--tls.join",
                 "true", "--remove-edges.isolated", "true", "--keep-edges.by-vclass", "passenger"});
    if (text.find("<lane ") == std::string::npos) failWithoutRoads(source);
    return text;
  } catch (const core::InputError& error) {
    if (saysNoRoads(error.what())) failWithoutRoads(source);
    throw;
  }
}

fs::path networkFile(const std::string& source) {
  if (source.empty())
    throw core::InputError("no network was given; a file or a shipped name was expected");
  if (core::isFile(source)) return source;
  const bool is_path = source.find('/') != std::string::npos || core::endsWith(source, ".xml") ||
                       core::endsWith(source, ".xodr") || core::endsWith(source, ".osm");
  if (is_path && core::isFolder(source)) {
    throw core::InputError("network '" + source + "' is a folder; a file was expected");
  }
  if (is_path && fs::exists(source))
    throw core::InputError("network '" + source + "' is no regular file; a file was expected");
  if (is_path) throw core::InputError("network file '" + source + "' does not exist");
  const fs::path folder = core::shareFolder() / "networks";
  const fs::path file = folder / source / (source + ".net.xml");
  if (core::isFile(file)) return file;
  const std::string nearest = core::nearestName(source, shippedNames(folder));
  throw core::InputError(
      "network '" + source + "' is neither a file nor shipped in '" + folder.string() + "'" +
      (nearest.empty() ? "" : "; the nearest shipped name is '" + nearest + "'"));
}

ImportedNetwork importNetwork(const std::string& source) {
  ImportedNetwork network;
  network.source = networkFile(source);
  const std::string content = core::readFile(network.source, "network");
  network.source_sha256 = core::sha256(content);
  if (isOpenDrive(network.source.string(), content)) {
    // netconvert would take it for right-hand traffic.
    if (content.find("rule=\"LHT\"") != std::string::npos)
      throw core::InputError("network '" + network.source.string() +
                             "': a road has rule=\"LHT\"; left-hand traffic is not supported");
    importConverted({"OpenDRIVE", "<OpenDRIVE", convertOpenDrive}, content, network);
    if (withSpeedsOfRoadTypes(content)) {
      network.changes.emplace_back("gave lanes without a limit the one of their road's type");
    }
  } else if (isOpenStreetMap(network.source.string(), content)) {
    importConverted({"OpenStreetMap", "<osm", convertOpenStreetMap}, content, network);
  } else {
    importSumoNetwork(content, network);
  }
  return network;
}

}  // namespace cdiff::map

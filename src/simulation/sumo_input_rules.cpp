// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_input_rules.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <pugixml.hpp>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::simulation {
namespace {

using core::InputError;

bool isAnyOf(std::string_view text, std::initializer_list<std::string_view> known) {
  return std::find(known.begin(), known.end(), text) != known.end();
}

bool startsWithAnyOf(std::string_view text, std::initializer_list<std::string_view> starts) {
  return std::any_of(starts.begin(), starts.end(), [text](std::string_view start) {
    return text.substr(0, start.size()) == start;
  });
}

/// The words of a name of SUMO's, in lower case: "device.ssm.edgeFile" has device, ssm, edge, file.
std::vector<std::string> wordsOf(std::string_view name) {
  std::string spaced;
  bool upper = false;  // the letter before: capitals in a row are one word
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isupper(byte) != 0 && !upper) spaced += ' ';
    upper = std::isupper(byte) != 0;
    spaced += std::isalnum(byte) != 0 ? letter : ' ';
  }
  return core::splitText(core::lowerCase(spaced), ' ');
}

/// Whether a key of SUMO's, or one of a later version, may name a file.
bool mayNameFile(std::string_view key) {
  const std::vector<std::string> words = wordsOf(key);
  return std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return isAnyOf(word, {"file", "files", "filename", "output", "outputs", "outfile", "outputfile",
                          "log", "logfile", "dest", "dump", "href"});
  });
}

/// SUMO's devices: rerouting, driver state and blue light write nothing; the others do, or nothing
/// here needs them. SUMO looks for no file behind a key without a dot.
bool isHarmlessOfVehicle(std::string_view key) {
  if (mayNameFile(key)) return false;
  if (key.find('.') == std::string_view::npos) return true;
  return isAnyOf(key, {"has.rerouting.device", "has.driverstate.device", "has.bluelight.device"}) ||
         startsWithAnyOf(key, {"device.rerouting.", "device.driverstate.", "device.bluelight.",
                               "junctionModel.", "laneChangeModel.", "carFollowModel.", "parking.",
                               "rerouting."});
}

bool isHarmlessOfRoad(std::string_view key) { return !mayNameFile(key); }

bool isDemandElement(std::string_view element) {
  return isAnyOf(element, {"routes",
                           "vType",
                           "vTypeDistribution",
                           "route",
                           "routeDistribution",
                           "vehicle",
                           "trip",
                           "flow",
                           "interval",
                           "stop",
                           "param",
                           "person",
                           "personFlow",
                           "personTrip",
                           "walk",
                           "ride",
                           "container",
                           "containerFlow",
                           "transport",
                           "tranship"}) ||
         startsWithAnyOf(element, {"carFollowing-"});
}

bool isNetworkElement(std::string_view element) {
  return isAnyOf(
      element, {"net",        "location",    "type",       "restriction", "preference", "laneType",
                "stopOffset", "edge",        "lane",       "neigh",       "param",      "tlLogic",
                "phase",      "condition",   "assignment", "function",    "junction",   "request",
                "connection", "prohibition", "roundabout"});
}

bool isHarmlessSignal(std::string_view type) {
  return isAnyOf(type, {"", "static", "actuated", "delay_based", "NEMA", "off", "rail_signal",
                        "rail_crossing"});
}

/// What a file may hold.
struct InputRules {
  bool (*element)(std::string_view element);
  bool (*parameter)(std::string_view key);
  const char* holds;  ///< for errors
};

constexpr InputRules kDemandRules = {
    isDemandElement, isHarmlessOfVehicle,
    "a demand holds vehicles, persons and containers with their types, routes and stops"};
constexpr InputRules kNetworkRules = {isNetworkElement, isHarmlessOfRoad,
                                      "a network holds roads, junctions and signals"};

/// One file while it is looked through.
class SumoInput : private pugi::xml_tree_walker {
 public:
  SumoInput(std::string_view text, const std::string& name, const InputRules& rules)
      : text_(text), name_(name), rules_(rules) {}

  void check() {
    requirePlainText();
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(text_.data(), text_.size(), kParsing, pugi::encoding_utf8);
    // Also what stands before a fault: SUMO does as it says before it comes to the fault.
    document.traverse(*this);
    if (!parsed) throw InputError(at(parsed.offset) + ": not XML: " + parsed.description());
    const std::size_t last = text_.find_last_not_of(kSpace);
    if (text_[last] != '>')
      throw InputError(name_ + ": goes on after its last element; delete what stands there");
  }

 private:
  static constexpr unsigned int kParsing =
      pugi::parse_default | pugi::parse_doctype | pugi::parse_declaration;
  static constexpr std::string_view kSpace = " \t\r\n";
  static constexpr int kDeepest = 20;  // SUMO's own files: 5

  /// SUMO unpacks what does not start like XML, and pugixml skips it: both must read the same
  /// letters from the first to the last.
  void requirePlainText() const {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    const bool marked = text_.substr(0, kMark.size()) == kMark;
    const std::string_view text = text_.substr(marked ? kMark.size() : 0);
    const std::size_t first = text.find_first_not_of(kSpace);
    if (first == std::string_view::npos || text[first] != '<')
      throw InputError(name_ + ": does not start with <; an XML file was expected");
    const auto control = std::find_if(text_.begin(), text_.end(), [&](unsigned char letter) {
      return letter < 0x20 && kSpace.find(static_cast<char>(letter)) == std::string_view::npos;
    });
    if (control != text_.end())
      throw InputError(at(control - text_.begin()) + ": holds a " +
                       (*control == '\0' ? "zero byte" : "control character") +
                       "; text was expected");
  }

  std::string at(std::ptrdiff_t offset) const {
    const std::string_view before =
        text_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, offset)));
    return name_ + ", line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n'));
  }

  [[noreturn]] void refuse(const pugi::xml_node& node, const std::string& subject,
                           const std::string& reason) const {
    throw InputError(at(node.offset_debug()) + ": " + core::shortened(subject) + ": " + reason);
  }

  bool for_each(pugi::xml_node& node) override {
    if (node.type() == pugi::node_doctype)
      refuse(node, "<!DOCTYPE>", "definitions of a document are not read; delete it");
    if (node.type() == pugi::node_declaration) checkEncoding(node);
    if (node.type() == pugi::node_element) checkElement(node);
    return true;
  }

  void checkElement(const pugi::xml_node& node) const {
    const std::string element = node.name();
    const std::string tag = "<" + element + ">";
    if (!rules_.element(element))
      refuse(node, tag, std::string(rules_.holds) + "; delete this element");
    if (element == "param") checkParameter(node);
    if (element == "tlLogic") checkSignal(node);
    checkAttributes(node);
    if (depth() > kDeepest) refuse(node, tag, "elements are nested too deeply");
  }

  void checkParameter(const pugi::xml_node& node) const {
    const std::string key = node.attribute("key").value();
    if (rules_.parameter(key)) return;
    refuse(node, "<param key=\"" + key + "\">",
           "with this key SUMO may write files, or it is not known not to; delete the parameter "
           "(what happened is in the session's own results)");
  }

  void checkSignal(const pugi::xml_node& node) const {
    const std::string type = node.attribute("type").value();
    if (isHarmlessSignal(type)) return;
    refuse(node, "<tlLogic type=\"" + type + "\">",
           "expected one of static, actuated, delay_based, NEMA, off, rail_signal, rail_crossing");
  }

  void checkAttributes(const pugi::xml_node& node) const {
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      const std::string key = attribute.name();
      // Pictures of a vehicle, which only SUMO's window shows.
      if (!mayNameFile(key) || key == "imgFile" || key == "osgFile") continue;
      refuse(node, std::string("<") + node.name() + " " + key + "=...>",
             "this attribute may name a file; delete it");
    }
  }

  /// SUMO decodes as the declaration says; in others than these a letter may stand for a bracket.
  void checkEncoding(const pugi::xml_node& node) const {
    const std::string encoding = core::lowerCase(node.attribute("encoding").value());
    const bool plain = isAnyOf(encoding, {"", "utf-8", "utf8", "ascii", "us-ascii", "latin1"}) ||
                       startsWithAnyOf(encoding, {"iso-8859-", "windows-125"});
    if (plain) return;
    refuse(node, "encoding=\"" + encoding + "\"", "expected UTF-8; save the file so");
  }

  std::string_view text_;
  const std::string& name_;
  const InputRules& rules_;
};

}  // namespace

void requireHarmlessDemand(std::string_view text, const std::string& name) {
  SumoInput(text, name, kDemandRules).check();
}

void requireHarmlessNetwork(std::string_view text, const std::string& name) {
  SumoInput(text, name, kNetworkRules).check();
}

void requirePlainPath(const std::filesystem::path& file, const std::string& name) {
  const std::string path = file.string();
  if (path.find(',') == std::string::npos && path.find("${") == std::string::npos) return;
  throw InputError(name + ": SUMO takes ',' and '${' in a path for more than a name; rename it");
}

}  // namespace cdiff::simulation

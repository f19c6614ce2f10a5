// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Names and texts from outside that try to be more than text, a session that has them everywhere,
/// and a reader of the elements that a page has.
#pragma once

#include <cctype>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "record/seen_session.h"
#include "record/verdict_cases.h"

namespace cdiff::test {

/// An element, quotes, an entity, ends of CDATA and comments, control characters, marks that turn
/// the direction of writing (U+202E, U+2066), an emoji and a byte that is no UTF-8.
inline const std::string& outsideText() {
  static const std::string text =
      "<script>alert(1)</script>\"'&amp;]]>--><!--|[a](b)\x01\x7f\n\u202Edrow\u2066\U0001F600\xff";
  return text;
}

/// How it starts where it is shown as text.
inline const char* escapedText() { return "&lt;script&gt;alert(1)&lt;/script&gt;&quot;&#39;&amp;"; }

/// 10 000 letters without a space.
inline std::string longText() { return std::string(10000, 'W'); }

/// Whether the text has none of the marks and control characters of `outsideText` in it.
inline bool isPlain(const std::string& text) {
  for (const char* mark : {"\x01", "\x7f", "\u202E", "\u2066", "\xff"}) {
    if (text.find(mark) != std::string::npos) return false;
  }
  return true;
}

/// Reads start and end tags of a page as strictly as the pages are written. Each start tag is its
/// name and the names of its attributes ("svg role viewBox"), each end tag "/svg". A tag of another
/// form is "broken: " with what follows.
class TagReader {
 public:
  explicit TagReader(std::string html) : html_(std::move(html)) {}

  std::vector<std::string> tags() {
    std::vector<std::string> tags;
    for (at_ = html_.find('<'); at_ != std::string::npos; at_ = html_.find('<', at_)) {
      const std::size_t begin = at_++;
      const std::string tag = readTag();
      tags.push_back(tag.empty() ? "broken: " + html_.substr(begin, 60) : tag);
      const std::string name = tag.substr(0, tag.find(' '));
      if (name == "script" || name == "style") at_ = html_.find("</" + name, at_);
      if (at_ == std::string::npos) break;
    }
    return tags;
  }

 private:
  bool take(const std::string& text) {
    if (html_.compare(at_, text.size(), text) != 0) return false;
    at_ += text.size();
    return true;
  }

  std::string takeName() {
    const std::size_t begin = at_;
    while (at_ < html_.size() && (std::isalnum(static_cast<unsigned char>(html_[at_])) != 0 ||
                                  html_[at_] == '-' || html_[at_] == ':'))
      ++at_;
    return html_.substr(begin, at_ - begin);
  }

  /// After '<'. Empty for what is no tag.
  std::string readTag() {
    if (take("!DOCTYPE html>")) return "!DOCTYPE";
    if (take("?xml version=\"1.0\" encoding=\"UTF-8\"?>")) return "?xml";
    if (take("/")) {
      const std::string name = takeName();
      return !name.empty() && take(">") ? "/" + name : "";
    }
    std::string tag = takeName();
    while (!tag.empty() && take(" ")) {
      const std::string name = takeName();
      if (name.empty() || (take("=") && !takeValue())) return "";
      tag += " " + name;
    }
    return !tag.empty() && (take(">") || take("/>")) ? tag : "";
  }

  bool takeValue() {
    if (!take("\"")) return false;
    const std::size_t end = html_.find_first_of("\"<>", at_);
    if (end == std::string::npos || html_[end] != '"') return false;
    at_ = end + 1;
    return true;
  }

  std::string html_;
  std::size_t at_ = 0;
};

inline std::vector<std::string> tagsOf(const std::string& html) { return TagReader(html).tags(); }

/// The same of a text that must be XML: elements with their attributes, in order; "no XML" and why
/// where it is none.
inline std::vector<std::string> xmlElementsOf(const std::string& text) {
  struct Walker final : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (node.type() != pugi::node_element) return true;
      std::string element = std::to_string(depth()) + " " + node.name();
      for (const pugi::xml_attribute& attribute : node.attributes())
        element += " " + std::string(attribute.name());
      elements.push_back(element);
      return true;
    }
    std::vector<std::string> elements;
  };
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_string(text.c_str());
  if (!result) return {std::string("no XML: ") + result.description()};
  Walker walker;
  document.traverse(walker);
  return walker.elements;
}

inline session::ScenarioOptions namedOptions(const std::string& text) {
  session::ScenarioOptions options = sampleOptions();
  options.name = "scenario " + text;
  options.verdict = session::VerdictOptions::standard();
  return options;
}

inline map::ImportedNetwork namedImport(const std::string& text) {
  map::ImportedNetwork import = crossingImport();
  import.source = "network" + text + ".net.xml";
  import.changes = {"change " + text};
  return import;
}

/// The setup of the sample session with `text` in every name that it has from outside.
struct NamedSetup {
  explicit NamedSetup(const std::string& text)
      : setup(namedOptions(text), namedImport(text), lineOf({5.0, -2.0, 0.0}, {195.0, -2.0, 0.0})) {
  }
  session::SessionSetup setup;
};

inline record::RunFacts namedFacts(const std::string& text) {
  return {"deployment " + text, "SUMO " + text, true};
}

/// What is shown of one tick of the session of 6 s with images, plans, guidance, late answers,
/// faults and a contact; every vehicle but the ego, planner, objective and fault has `text` behind
/// its name.
struct NamedTick {
  NamedTick(std::uint64_t tick, const std::string& text, const session::SessionSetup& setup)
      : snapshot(sampleSnapshot(tick)), selection(sampleSelection(tick, setup.network())) {
    addTouch(snapshot, Touch::kEgoAtFault);
    for (traffic::Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role != traffic::VehicleRole::kEgo) vehicle.id += text;
    }
    for (auto& contact : snapshot.contacts) contact.first += text;  // the second is the ego
    for (auto& rejected : selection.rejected) rejected.vehicle_id += text;
    for (cbv::CbvAssignment& assignment : selection.assignments) assignment.vehicle_id += text;
    if (tick == 60) snapshot.faults = {{60, "source " + text, "fault " + text}};
    if (tick == 120) snapshot.status = traffic::SessionStatus::kTimedOut;
    if (tick >= 52) addPlan(tick, text);
  }

  session::TickRecord record(const std::string& text) const {
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (!snapshot.decision_tick) return record;
    record.selection = &selection;
    record.actions = &actions;
    record.images = &images;
    record.latencies = {{"ego:" + text, 1.0}};
    record.timings = {{"cbv:" + text, true, 0.2, session::AnswerTiming::Instead::kPlan}};
    return record;
  }

  void addPlan(std::uint64_t tick, const std::string& text) {
    planning::PlannedAction action = sampleAction(tick);
    action.vehicle_id += text;
    for (auto& objective : action.guidance.objectives) objective.name += text;
    actions.push_back(action);
    images.push_back({0, redAndBlue(tick)});
  }

  traffic::TrafficSnapshot snapshot;
  cbv::CbvSelection selection;
  std::vector<planning::PlannedAction> actions = {{-1, "ego", {}, {}}};
  std::vector<session::SlotImage> images;
};

/// Writes the result folder of that session.
inline void writeNamedSession(const std::filesystem::path& folder, const std::string& text) {
  const NamedSetup named(text);
  page::ResultWriter writer(named.setup, namedFacts(text), folder);
  for (std::uint64_t tick = 0; tick <= 120; ++tick) {
    const NamedTick shown(tick, text, named.setup);
    writer.observe(shown.record(text));
  }
  writer.finish(2.0);
}

}  // namespace cdiff::test

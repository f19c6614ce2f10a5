// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/xosc_element.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::storyboard {

using core::InputError;

/// A file that was read.
struct XoscElement::Document {
  std::string file;
  std::string text;
  pugi::xml_document tree;

  std::vector<std::ptrdiff_t> line_ends;  ///< offsets of the text's line breaks

  void read(const std::string& name) {
    constexpr std::uintmax_t kLargest = std::uintmax_t{64} << 20;  // [bytes]
    file = name;
    text = core::readFile(name, "OpenSCENARIO file", kLargest);
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') line_ends.push_back(static_cast<std::ptrdiff_t>(i));
  }
  int lineAt(std::ptrdiff_t offset) const {
    const auto line = std::lower_bound(line_ends.begin(), line_ends.end(), offset);
    return 1 + static_cast<int>(line - line_ends.begin());
  }
};

namespace {

/// Finds an element that is nested too deeply: readers call each other for what is nested.
class TooDeep : public pugi::xml_tree_walker {
 public:
  pugi::xml_node found;

 private:
  bool for_each(pugi::xml_node& node) override {
    constexpr int kDeepest = 100;
    if (depth() > kDeepest) found = node;
    return !found;
  }
};

}  // namespace

XoscElement XoscElement::load(const std::string& file) {
  auto document = std::make_shared<Document>();
  document->read(file);
  const std::size_t doctype = document->text.find("<!DOCTYPE");
  if (doctype != std::string::npos) {
    throw InputError(file + ":" + std::to_string(document->lineAt(std::ptrdiff_t(doctype))) +
                     ": <!DOCTYPE> is refused, because it can name other files; delete it");
  }
  const pugi::xml_parse_result parsed =
      document->tree.load_buffer(document->text.data(), document->text.size());
  if (!parsed) {
    throw InputError(file + ":" + std::to_string(document->lineAt(parsed.offset)) +
                     ": not XML: " + parsed.description());
  }
  pugi::xml_node root = document->tree.child("OpenSCENARIO");
  if (!root) throw InputError(file + ":1: the root element <OpenSCENARIO> was expected");
  const XoscElement element{root, document, std::make_shared<const Parameters>(), 0};
  TooDeep too_deep;
  root.traverse(too_deep);
  if (too_deep.found) element.of(too_deep.found).fail("elements are nested too deeply");
  return element;
}

Source XoscElement::source() const {
  return {document_->file, document_->lineAt(node_.offset_debug())};
}

void XoscElement::fail(const std::string& text) const {
  throw InputError(source().text() + ": <" + name() + ">: " + text);
}

std::string XoscElement::text(const char* key) const {
  const pugi::xml_attribute attribute = node_.attribute(key);
  if (attribute.empty()) fail(std::string("the attribute '") + key + "' is missing");
  try {
    return resolved(attribute.value(), *parameters_);
  } catch (const InputError& error) {
    fail(std::string("attribute '") + key + "': " + error.what());
  }
}

std::string XoscElement::text(const char* key, const std::string& missing) const {
  return has(key) ? text(key) : missing;
}

double XoscElement::number(const char* key) const {
  const std::string value = text(key);
  const auto parsed = core::parseNumber(value);
  if (!parsed)
    fail(std::string("'") + key + "' is '" + core::shortened(value) + "'; expected a number");
  return *parsed;
}

double XoscElement::number(const char* key, double missing) const {
  return has(key) ? number(key) : missing;
}

double XoscElement::limit(const char* key, double missing) const {
  constexpr double kInfinite = 1e300;
  if (!has(key)) return missing;
  const bool computed = std::string_view(node_.attribute(key).value()).substr(0, 2) == "${";
  const std::string value = text(key);
  return !computed && (value == "INF" || value == "inf") ? kInfinite : number(key);
}

int XoscElement::integer(const char* key) const {
  const double value = number(key);
  if (value != std::round(value) || std::abs(value) > 1e9)
    fail(std::string("'") + key + "' is '" + text(key) + "'; expected a whole number");
  return static_cast<int>(value);
}

int XoscElement::integer(const char* key, int missing) const {
  return has(key) ? integer(key) : missing;
}

bool XoscElement::flag(const char* key, bool missing) const {
  if (!has(key)) return missing;
  const std::string value = text(key);
  if (value == "true" || value == "True" || value == "1") return true;
  if (value == "false" || value == "False" || value == "0") return false;
  fail(std::string("'") + key + "' is '" + core::shortened(value) + "'; expected true or false");
}

std::size_t XoscElement::choice(const char* key, const std::vector<std::string>& words) const {
  const std::string value = text(key);
  const auto found = std::find(words.begin(), words.end(), value);
  if (found == words.end()) {
    fail(std::string("'") + key + "' is '" + core::shortened(value) + "'; expected one of {" +
         core::joinText(words, ", ") + "}");
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<XoscElement> XoscElement::children() const {
  std::vector<XoscElement> elements;
  for (const pugi::xml_node& node : node_.children())
    if (node.type() == pugi::node_element) elements.push_back(of(node));
  return elements;
}

std::vector<XoscElement> XoscElement::children(const char* name) const {
  std::vector<XoscElement> elements;
  for (const pugi::xml_node& node : node_.children(name)) elements.push_back(of(node));
  return elements;
}

std::optional<XoscElement> XoscElement::find(const char* name) const {
  const pugi::xml_node node = node_.child(name);
  if (!node) return std::nullopt;
  return of(node);
}

XoscElement XoscElement::child(const char* name) const {
  const auto found = find(name);
  if (!found) fail(std::string("the element <") + name + "> is missing");
  return *found;
}

XoscElement XoscElement::only() const {
  const std::vector<XoscElement> elements = children();
  if (elements.empty()) fail("an element inside it is missing");
  if (elements.size() > 1) elements[1].fail("one element was expected inside <" + name() + ">");
  return elements.front();
}

XoscElement XoscElement::with(const Parameters& more) const {
  Parameters all = more;
  all.insert(parameters_->begin(), parameters_->end());
  return {node_, document_, std::make_shared<const Parameters>(std::move(all)), entries_};
}

XoscElement XoscElement::asEntryFor(const XoscElement& referring) const {
  constexpr int kDeepest = 8;
  if (referring.entries_ >= kDeepest)
    fail("entries of catalogs refer to each other in a circle; expected an end");
  return {node_, document_, parameters_, referring.entries_ + 1};
}

XoscElement XoscElement::declaring(const Parameters& given) const {
  std::set<std::string> declared;
  const auto list = find("ParameterDeclarations");
  const auto known = std::make_shared<Parameters>(*parameters_);  // grows by each declaration
  const XoscElement scope{node_, document_, known, entries_};
  if (list) {
    for (const pugi::xml_node& node : list->node_.children("ParameterDeclaration")) {
      const XoscElement declaration = scope.of(node);
      const std::string name = declaration.text("name");
      const auto replaced = given.find(name);
      (*known)[name] = replaced != given.end() ? replaced->second : declaration.text("value");
      declared.insert(name);
    }
  }
  for (const auto& entry : given)
    if (declared.count(entry.first) == 0)
      fail("it does not declare the parameter '" + entry.first + "', which is given to it");
  return scope;
}

}  // namespace cdiff::storyboard

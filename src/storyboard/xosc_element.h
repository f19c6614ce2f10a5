// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "storyboard/expression.h"
#include "storyboard/scenario.h"

namespace cdiff::storyboard {

/// An element of an OpenSCENARIO file: checked access to its attributes, with parameters and
/// expressions resolved. Every error names file and line.
class XoscElement {
 public:
  /// The root element of a file. Throws InputError for a file that cannot be read, is no XML, has a
  /// <!DOCTYPE>, which could name other files, or another root.
  static XoscElement load(const std::string& file);

  std::string name() const { return node_.name(); }
  Source source() const;
  /// Throws InputError with file and line.
  [[noreturn]] void fail(const std::string& text) const;

  /// Value of an attribute; without a default it must be there.
  std::string text(const char* key) const;
  std::string text(const char* key, const std::string& missing) const;
  /// The attribute as it stands in the file, empty where it is missing: a label that nobody refers
  /// to, which may hold no expression of ours.
  std::string plainText(const char* key) const { return node_.attribute(key).value(); }
  /// A finite number.
  double number(const char* key) const;
  double number(const char* key, double missing) const;
  /// A number that may be INF, which stands for no limit.
  double limit(const char* key, double missing) const;
  int integer(const char* key) const;
  int integer(const char* key, int missing) const;
  /// true or false, also as True and False, 1 and 0.
  bool flag(const char* key, bool missing) const;
  bool has(const char* key) const { return !node_.attribute(key).empty(); }
  /// One of these words, as its index.
  std::size_t choice(const char* key, const std::vector<std::string>& words) const;

  /// The element's children; with a name, those of that name.
  std::vector<XoscElement> children() const;
  std::vector<XoscElement> children(const char* name) const;
  std::optional<XoscElement> find(const char* name) const;
  /// Must be there.
  XoscElement child(const char* name) const;
  /// The one child element, whatever its name. Throws InputError where there are none or more.
  XoscElement only() const;

  const Parameters& parameters() const { return *parameters_; }
  /// The same element with further parameters, which replace those of the same name.
  XoscElement with(const Parameters& more) const;
  /// The same element as an entry of a catalog. Throws InputError where entries refer to each other
  /// in a circle: `referring` has come through too many.
  XoscElement asEntryFor(const XoscElement& referring) const;
  /// The same with what its <ParameterDeclarations> declare; `given` has the values of those that
  /// somebody else gives. Throws InputError for a given name that is not declared.
  XoscElement declaring(const Parameters& given = {}) const;

 private:
  struct Document;
  XoscElement(pugi::xml_node node, std::shared_ptr<const Document> document,
              std::shared_ptr<const Parameters> parameters, int entries)
      : node_(node),
        document_(std::move(document)),
        parameters_(std::move(parameters)),
        entries_(entries) {}
  XoscElement of(pugi::xml_node node) const { return {node, document_, parameters_, entries_}; }

  pugi::xml_node node_;
  std::shared_ptr<const Document> document_;
  std::shared_ptr<const Parameters> parameters_;
  int entries_ = 0;  ///< of catalogs, through which one comes to the element
};

}  // namespace cdiff::storyboard

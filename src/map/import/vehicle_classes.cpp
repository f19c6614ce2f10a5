// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/import/vehicle_classes.h"

#include <algorithm>
#include <array>

#include "core/text.h"

namespace cdiff::map {
namespace {

constexpr std::array<std::string_view, 7> kUnknown = {
    "container", "cable_car", "subway", "aircraft", "wheelchair", "scooter", "drone"};
constexpr std::string_view kSpace = " \t\r\n";

/// Place of an attribute inside a tag's text.
struct Attribute {
  std::size_t begin = 0;  ///< of the white space before the name
  std::string_view space;
  std::string_view name;
  std::string_view value;
  std::size_t end = 0;  ///< after the closing quote
};

/// The attribute after `from`; its name is empty at the end of the tag.
Attribute nextAttribute(std::string_view tag, std::size_t from) {
  Attribute found;
  found.begin = tag.find_first_of(kSpace, from);
  if (found.begin == std::string_view::npos) return found;
  const std::size_t name = tag.find_first_not_of(kSpace, found.begin);
  const std::size_t equals = tag.find('=', found.begin);
  const std::size_t open = tag.find_first_of("\"'", found.begin);
  if (equals == std::string_view::npos || open == std::string_view::npos) return found;
  const std::size_t close = tag.find(tag[open], open + 1);
  if (close == std::string_view::npos || equals > open || name >= equals) return found;
  found.space = tag.substr(found.begin, name - found.begin);
  found.name = tag.substr(name, std::min(tag.find_first_of(kSpace, name), equals) - name);
  found.value = tag.substr(open + 1, close - open - 1);
  found.end = close + 1;
  return found;
}

/// End of the tag that starts at `begin`, behind its '>'.
std::size_t endOfTag(std::string_view text, std::size_t begin) {
  char quote = '\0';
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (quote != '\0') {
      if (text[i] == quote) quote = '\0';
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '>') {
      return i + 1;
    }
  }
  return text.size();
}

/// End of a piece that is copied as it is: comment, declaration or processing instruction; 0 when
/// `begin` opens a tag.
std::size_t endOfVerbatim(std::string_view text, std::size_t begin) {
  const auto until = [&](std::string_view mark) {
    const std::size_t end = text.find(mark, begin);
    return end == std::string_view::npos ? text.size() : end + mark.size();
  };
  if (text.substr(begin, 4) == "<!--") return until("-->");
  if (text.substr(begin, 9) == "<![CDATA[") return until("]]>");
  if (text.substr(begin, 2) == "<?") return until("?>");
  return 0;
}

class Rewriter {
 public:
  PermissionRewrite rewrite(std::string_view text) {
    result_.text.reserve(text.size());
    std::size_t cursor = 0;
    while (cursor < text.size()) {
      const std::size_t open = std::min(text.find('<', cursor), text.size());
      result_.text += text.substr(cursor, open - cursor);
      if (open == text.size()) break;
      const std::size_t verbatim = endOfVerbatim(text, open);
      const std::size_t end = verbatim > 0 ? verbatim : endOfTag(text, open);
      const std::string_view piece = text.substr(open, end - open);
      if (verbatim > 0) {
        result_.text += piece;
      } else {
        rewriteTag(piece);
      }
      cursor = end;
    }
    noteRemoved();
    return std::move(result_);
  }

 private:
  void rewriteTag(std::string_view tag) {
    const bool closes = isEmptied(tag);
    std::size_t cursor = 0;
    for (Attribute at = nextAttribute(tag, 0); !at.name.empty(); at = nextAttribute(tag, at.end)) {
      const bool allow = at.name == "allow";
      if (!allow && at.name != "disallow") continue;
      const std::string kept = keptClasses(at.value);
      const bool same = kept == at.value && !closes;
      const std::size_t copied = same ? at.end : at.begin;
      result_.text += tag.substr(cursor, copied - cursor);
      cursor = at.end;
      if (closes && allow) result_.text += std::string(at.space) + "disallow=\"all\"";
      if (same || closes || kept.empty()) continue;
      result_.text += std::string(at.space) + std::string(at.name) + "=\"" + kept + "\"";
    }
    result_.text += tag.substr(cursor);
  }

  /// Whether the tag's `allow` names unknown classes only: afterward nothing may use the lane.
  static bool isEmptied(std::string_view tag) {
    for (Attribute at = nextAttribute(tag, 0); !at.name.empty(); at = nextAttribute(tag, at.end)) {
      if (at.name != "allow") continue;
      const std::vector<std::string> words = core::splitText(at.value, ' ');
      return !words.empty() && std::all_of(words.begin(), words.end(), isUnknown);
    }
    return false;
  }

  static bool isUnknown(const std::string& word) {
    return std::find(kUnknown.begin(), kUnknown.end(), word) != kUnknown.end();
  }

  /// The value without unknown classes; the value itself when it names none.
  std::string keptClasses(std::string_view value) {
    std::vector<std::string> kept;
    bool unknown = false;
    for (const std::string& word : core::splitText(value, ' ')) {
      const auto found = std::find(kUnknown.begin(), kUnknown.end(), word);
      if (found == kUnknown.end()) {
        kept.push_back(word);
        continue;
      }
      unknown = true;
      seen_[static_cast<std::size_t>(found - kUnknown.begin())] = true;
    }
    if (!unknown) return std::string(value);
    ++result_.attributes;
    return core::joinText(kept, " ");
  }

  void noteRemoved() {
    for (std::size_t i = 0; i < kUnknown.size(); ++i) {
      if (seen_[i]) result_.removed.emplace_back(kUnknown[i]);
    }
  }

  PermissionRewrite result_;
  std::array<bool, kUnknown.size()> seen_{};
};

}  // namespace

PermissionRewrite dropUnknownClasses(std::string_view text) { return Rewriter().rewrite(text); }

}  // namespace cdiff::map

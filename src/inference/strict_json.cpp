// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/strict_json.h"

#include <set>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::inference {
namespace {

constexpr int kMaxDepth = 8;
constexpr std::size_t kMaxElements = 65536;
constexpr std::size_t kMaxKey = 256;
constexpr std::size_t kMaxRun = 1u << 20;
constexpr std::size_t kExcerpt = 100;

/// Watches the parser's events; the keys of every object that is open.
class Watcher {
 public:
  explicit Watcher(const std::string& source) : source_(source) {}

  void see(int depth, Json::parse_event_t event, const Json& parsed) {
    if (++elements_ > kMaxElements) {
      fail("more than " + std::to_string(kMaxElements) + " values and keys");
    }
    if (depth > kMaxDepth) fail("nested deeper than " + std::to_string(kMaxDepth));
    if (event == Json::parse_event_t::object_start) {
      open_.emplace_back();
    } else if (event == Json::parse_event_t::object_end) {
      open_.pop_back();
    } else if (event == Json::parse_event_t::key) {
      const std::string& key = parsed.get_ref<const std::string&>();
      if (key.size() > kMaxKey) fail("a key of " + std::to_string(key.size()) + " bytes");
      if (!open_.back().insert(key).second) fail("duplicate key '" + key + "'");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw core::InputError(source_ + ": the JSON has a fault: " + what);
  }

  const std::string& source_;
  std::size_t elements_ = 0;
  std::vector<std::set<std::string>> open_;
};

/// Refuses a string, or text between two strings, of more than kMaxRun bytes: the parser would keep
/// several copies of it.
void requireShortRuns(std::string_view text, const std::string& source) {
  bool inside = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i == text.size() || text[i] == '"') {
      if (i - begin > kMaxRun) {
        throw core::InputError(source + ": the JSON has a fault: " +
                               (inside ? "a string" : "a stretch without strings") + " of " +
                               std::to_string(i - begin) + " bytes");
      }
      inside = !inside;
      begin = i + 1;
    } else if (inside && text[i] == '\\' && i + 1 < text.size()) {
      ++i;
    }
  }
}

}  // namespace

Json parseStrictJson(std::string_view text, const std::string& source) {
  requireShortRuns(text, source);
  Watcher watcher(source);
  const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    watcher.see(depth, event, parsed);
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::exception& error) {
    throw core::InputError(source + " is not JSON: " + excerpt(error.what()));
  }
}

std::string kindOf(const Json& value) {
  switch (value.type()) {
    case Json::value_t::object:
      return "an object";
    case Json::value_t::array:
      return "an array";
    case Json::value_t::string:
      return "a string";
    case Json::value_t::boolean:
      return "a boolean";
    case Json::value_t::number_integer:
    case Json::value_t::number_unsigned:
      return "an integer";
    case Json::value_t::number_float:
      return "a number with a fraction";
    default:
      return "null";
  }
}

std::string excerpt(const std::string& text) {
  return text.size() <= kExcerpt ? text : text.substr(0, kExcerpt) + " ...";
}

}  // namespace cdiff::inference

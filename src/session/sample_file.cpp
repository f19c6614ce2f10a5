// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/sample_file.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {
namespace {

using core::InputError;
using nlohmann::json;

constexpr std::size_t kMostSamples = 250000;  // a resolved scenario holds them all
constexpr const char* kBlank = " \t\r\n";

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(kBlank);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<double> fromLines(const std::string& text, const std::string& file) {
  std::vector<double> samples;
  std::stringstream stream(text);
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string content = trimmed(line.substr(0, line.find('#')));
    if (content.empty()) continue;
    const auto value = core::parseNumber(content);
    if (!value) {
      throw InputError(file + ":" + std::to_string(number) + ": \"" + content +
                       "\", expected one finite number a line");
    }
    samples.push_back(*value);
  }
  return samples;
}

std::vector<double> fromCase(const json& entry, const std::string& place) {
  const auto found = entry.is_object() ? entry.find("x") : entry.end();
  if (found == entry.end() || !found->is_array())
    throw InputError(place + ": expected a list \"x\" of numbers");
  std::vector<double> samples;
  for (const json& value : *found) {
    if (!value.is_number()) {
      throw InputError(place + ": \"x\" holds " + value.dump() + ", expected numbers");
    }
    samples.push_back(value.get<double>());
  }
  return samples;
}

std::vector<double> fromJson(const std::string& text, const std::string& file) {
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    throw InputError(file + ": not JSON: " + error.what());
  }
  const auto cases = document.find("cases");
  if (cases == document.end() || !cases->is_array())
    throw InputError(file + ": expected an object with a list \"cases\"");
  std::vector<double> samples;
  for (std::size_t i = 0; i < cases->size(); ++i) {
    const auto more = fromCase((*cases)[i], file + ": case " + std::to_string(i + 1));
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return samples;
}

}  // namespace

std::vector<double> readSamples(const std::filesystem::path& file) {
  const std::string text = core::readFile(file, "file of samples");
  const auto first = text.find_first_not_of(kBlank);
  const bool is_json = first != std::string::npos && text[first] == '{';
  const std::vector<double> samples =
      is_json ? fromJson(text, file.string()) : fromLines(text, file.string());
  if (samples.empty()) throw InputError(file.string() + ": holds no sample");
  if (samples.size() > kMostSamples) {
    throw InputError(file.string() + ": holds " + std::to_string(samples.size()) +
                     " samples; at most " + std::to_string(kMostSamples) +
                     " were expected, every n-th will do");
  }
  return samples;
}

}  // namespace cdiff::session

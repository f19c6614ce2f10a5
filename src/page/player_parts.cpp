// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/player_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/angle.h"
#include "record/logs/cbv_log.h"

namespace cdiff::page {
namespace {

using PlayerNumbers = nlohmann::ordered_json;

constexpr std::size_t kFirstCbvStyle = 2;
constexpr float kLongestFrameTime = 100.0F;  // to a collision [s]

std::vector<std::uint8_t> bytesOfHex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

}  // namespace

const std::vector<std::string>& vehicleStyles() {
  static const std::vector<std::string> kStyles = {"ego",    "bg",     "cbv c0", "cbv c1",
                                                   "cbv c2", "cbv c3", "cbv c4"};
  return kStyles;
}

std::size_t cbvStyleNumber(std::size_t n) {
  return kFirstCbvStyle + n % (vehicleStyles().size() - kFirstCbvStyle);
}

Markup sightFigure(int slot) {
  const Markup content = element("img", {{"width", "320"},
                                         {"height", "192"},
                                         {"alt", "Front view of a CBV"},
                                         core::flag("hidden")}) +
                         element("p", {{"class", "nothing"}}, "No CBV now") +
                         element("figcaption", {}, "");
  return element("figure", {{"class", "sight"}, {"data-slot", std::to_string(slot)}}, content) +
         "\n";
}

Markup momentTable() {
  Markup head = element("th", {{"scope", "col"}}, "Now");
  for (const char* name :
       {"Speed [m/s]", "Throttle", "Brake", "Steer", "Between outlines [m]", "2D-TTC [s]"}) {
    head += element("th", {{"scope", "col"}, {"class", "number"}}, name);
  }
  const Markup rows = element("thead", {}, element("tr", {}, head)) + element("tbody");
  return element("div", {{"class", "scroll"}},
                 element("table", {{"id", "moment"}, core::flag("hidden")}, rows)) +
         "\n";
}

Markup pageButton(const char* id, const std::string& text,
                  const std::vector<core::Attribute>& more) {
  std::vector<core::Attribute> attributes = {{"type", "button"}, {"id", id}};
  attributes.insert(attributes.end(), more.begin(), more.end());
  return element("button", attributes, text);
}

Markup pageChoice(const std::string& id, const std::vector<std::pair<std::string, std::string>>& of,
                  const std::string& selected) {
  Markup choices;
  for (const auto& [value, text] : of) {
    std::vector<core::Attribute> attributes = {{"value", value}};
    if (value == selected) attributes.push_back(core::flag("selected"));
    choices += element("option", attributes, text);
  }
  return element("select", {{"id", id}}, choices);
}

Markup zoomButtons() {
  return element("span", {{"class", "group"}},
                 pageButton("closer", "+", {{"aria-label", "Zoom in"}}) +
                     pageButton("farther", "−", {{"aria-label", "Zoom out"}}) +
                     pageButton("whole", "Whole picture"));
}

Markup followBox(bool checked) {
  std::vector<core::Attribute> attributes = {{"type", "checkbox"}, {"id", "follow"}};
  if (checked) attributes.push_back(core::flag("checked"));
  return element("label", {}, element("input", attributes) + " Follow the ego");
}

long roundedNumber(double value) { return std::isfinite(value) ? std::lround(value) : 0; }

nlohmann::ordered_json frameNumbers(const record::TimelineFrame& frame, const MapCanvas& canvas,
                                    const std::vector<std::size_t>& cbv_styles) {
  PlayerNumbers numbers = PlayerNumbers::array();
  for (auto pose = frame.poses.rbegin(); pose != frame.poses.rend(); ++pose) {
    if (!canvas.shows({pose->x, pose->y})) continue;
    const Eigen::Vector2d pixel = canvas.toPixels({pose->x, pose->y});
    const std::size_t style = pose->role == traffic::VehicleRole::kEgo   ? 0
                              : pose->role == traffic::VehicleRole::kCbv ? cbv_styles[pose->vehicle]
                                                                         : 1;
    numbers.push_back(pose->vehicle);
    numbers.push_back(style);
    numbers.push_back(roundedNumber(10.0 * pixel.x()));
    numbers.push_back(roundedNumber(10.0 * pixel.y()));
    numbers.push_back(roundedNumber(-core::radiansToDegrees(static_cast<double>(pose->heading))));
    numbers.push_back(roundedNumber(10.0 * static_cast<double>(pose->speed)));
  }
  return numbers;
}

nlohmann::ordered_json momentNumbers(const record::TimelineFrame& frame) {
  PlayerNumbers numbers = PlayerNumbers::array();
  for (const record::TimelinePose& pose : frame.poses) {
    if (pose.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    numbers.push_back(pose.vehicle);
    numbers.push_back(pose.slot);
    for (const float value : {pose.throttle, pose.brake, pose.steer, pose.gap,
                              std::min(pose.time_to_collision, kLongestFrameTime)}) {
      numbers.push_back(roundedNumber(100.0 * static_cast<double>(value)));
    }
  }
  return numbers;
}

std::string scriptHash(const core::Asset& script) {
  const std::string text = "\n" + std::string(script.text());  // as core::scriptElement writes it
  return "'sha256-" + record::base64(bytesOfHex(core::sha256(text))) + "'";
}

}  // namespace cdiff::page

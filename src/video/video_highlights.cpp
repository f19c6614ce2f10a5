// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/video_highlights.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace cdiff::video {
namespace {

using traffic::Vehicle;

/// Gap of the boxes [m]; 0 without ego.
double gapTo(const Vehicle* ego, const Vehicle& vehicle) {
  if (ego == nullptr || !isPlaced(*ego)) return 0.0;
  return geometry::distance(ego->box(), vehicle.box());
}

}  // namespace

bool isPlaced(const Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.elevation);
}

const Vehicle* FollowedCbv::update(const traffic::TrafficSnapshot& snapshot) {
  const Vehicle* nearest = nullptr;
  const Vehicle* shown = nullptr;
  for (const Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kCbv || !isPlaced(vehicle)) continue;
    if (vehicle.id == id_) shown = &vehicle;
    const Vehicle* ego = snapshot.ego();
    if (nearest == nullptr || gapTo(ego, vehicle) < gapTo(ego, *nearest)) nearest = &vehicle;
  }
  if (nearest == nullptr) {
    id_.clear();
    return nullptr;
  }
  const Vehicle* ego = snapshot.ego();
  const bool stay = shown != nullptr && gapTo(ego, *shown) < gapTo(ego, *nearest) + kMargin;
  if (!stay) shown = nearest;
  id_ = shown->id;
  return shown;
}

ContactMarks::ContactMarks(const session::SessionSetup& setup)
    : ego_contacts_(&setup.network(), setup.metricsOptions().infractions.collision_minimum_speed) {}

void ContactMarks::update(const traffic::TrafficSnapshot& snapshot) {
  ego_contacts_.observe(snapshot);
  for (; seen_ < ego_contacts_.contacts().size(); ++seen_) {
    const metrics::EgoContact& contact = ego_contacts_.contacts()[seen_];
    const std::string fault = contact.ego_at_fault ? ": ego at fault" : ": ego not at fault";
    marks_.push_back({contact.seconds,
                      {contact.x, contact.y},
                      contact.partner,
                      contact.ego_at_fault,
                      "ego and " + contact.partner + fault,
                      contact.reason});
  }
  addOthers(snapshot);
  while (!marks_.empty() && marks_.front().begin < snapshot.time - kContactTime) marks_.pop_front();
}

void ContactMarks::addOthers(const traffic::TrafficSnapshot& snapshot) {
  const Vehicle* ego = snapshot.ego();
  for (const traffic::Contact& contact : snapshot.contacts) {
    if (ego != nullptr && (contact.first == ego->id || contact.second == ego->id)) continue;
    const Vehicle* first = snapshot.find(contact.first);
    const Vehicle* second = snapshot.find(contact.second);
    if (first == nullptr || second == nullptr || !isPlaced(*first) || !isPlaced(*second)) continue;
    ContactMark mark;
    mark.begin = snapshot.time;
    mark.position = 0.5 * (first->state.position + second->state.position);
    mark.label = contact.first + " and " + contact.second;
    marks_.push_back(mark);
  }
}

const ContactMark* ContactMarks::ofEgo() const {
  for (auto mark = marks_.rbegin(); mark != marks_.rend(); ++mark) {
    if (!mark->partner.empty()) return &*mark;
  }
  return nullptr;
}

namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

/// A '?' for each character that the font has not.
std::string inAscii(const std::string& text) {
  std::string ascii;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    const bool continues = (code & 0xC0U) == 0x80U;  // of a character in UTF-8
    if (!continues) ascii += code >= 32 && code < 127 ? letter : '?';
  }
  return ascii;
}

}  // namespace

cv::Scalar inkOf(traffic::VehicleRole role, int slot) {
  if (role == traffic::VehicleRole::kEgo) return ink::kEgo;
  if (role == traffic::VehicleRole::kBackground) return ink::kBackground;
  static const cv::Scalar kShades[] = {
      {162, 31, 123}, {132, 24, 208}, {209, 59, 91}, {196, 107, 160}, {102, 13, 74}};
  return kShades[static_cast<std::size_t>(slot < 0 ? 0 : slot) % std::size(kShades)];
}

cv::Scalar inkOf(const ContactMark& contact) {
  if (contact.partner.empty()) return ink::kContact;
  return contact.ego_at_fault ? ink::kFailed : ink::kStruck;
}

void writeText(cv::Mat picture, const std::string& text, const cv::Point& at, double size,
               const cv::Scalar& color, bool bold) {
  cv::putText(picture, inAscii(text), at, kFont, size, color, bold ? 2 : 1, cv::LINE_AA);
}

int textWidth(const std::string& text, double size, bool bold) {
  return cv::getTextSize(inAscii(text), kFont, size, bold ? 2 : 1, nullptr).width;
}

std::string cutText(const std::string& text, int width, double size) {
  std::string cut = inAscii(text);
  if (textWidth(cut, size) <= width) return cut;
  while (!cut.empty() && textWidth(cut + "..", size) > width) cut.pop_back();
  return cut + "..";
}

}  // namespace cdiff::video

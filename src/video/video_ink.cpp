// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/video_ink.h"

#include <opencv2/imgproc.hpp>

namespace cdiff::video {
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

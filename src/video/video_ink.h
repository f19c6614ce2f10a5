// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Colours of the video (blue, green, red), those of the page's light palette, and text in it.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "e2e_cdiff/traffic/vehicle.h"
#include "video/video_focus.h"

namespace cdiff::video {

namespace ink {
inline const cv::Scalar kPage{255, 255, 255};
inline const cv::Scalar kText{36, 32, 28};
inline const cv::Scalar kSoft{112, 102, 93};
inline const cv::Scalar kPanel{248, 246, 245};
inline const cv::Scalar kGround{236, 241, 238};
inline const cv::Scalar kRoad{220, 215, 211};
inline const cv::Scalar kEdge{177, 169, 163};
inline const cv::Scalar kRoute{178, 222, 178};
inline const cv::Scalar kEgo{40, 40, 198};
inline const cv::Scalar kBackground{196, 111, 31};
inline const cv::Scalar kContact{0, 81, 230};
inline const cv::Scalar kPassed{54, 110, 27};
inline const cv::Scalar kFailed{25, 25, 163};
inline const cv::Scalar kStruck{0, 74, 122};
inline const cv::Scalar kError{134, 42, 91};
}  // namespace ink

/// Red for the ego, blue for background vehicles, a shade of purple by slot for CBVs.
cv::Scalar inkOf(traffic::VehicleRole role, int slot);

/// Red where the ego is at fault, amber where it is struck, orange where it has no part.
cv::Scalar inkOf(const ContactMark& contact);

/// One line of text, its left lower corner at `at` [pixels]; letters that are not ASCII appear as
/// '?'. `size` 1 is 22 pixels high.
void writeText(cv::Mat picture, const std::string& text, const cv::Point& at, double size,
               const cv::Scalar& color, bool bold = false);
/// Its width [pixels].
int textWidth(const std::string& text, double size, bool bold = false);
/// `text` cut to `width` pixels, with ".." where something is missing.
std::string cutText(const std::string& text, int width, double size);

}  // namespace cdiff::video

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "e2e_cdiff/core/exceptions.h"
#include "record/logs/cbv_log.h"

namespace cdiff::record {
namespace {

std::vector<std::uint8_t> bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(letters.find(letter));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(group >> bits & 255U));
  }
  return bytes;
}

TEST(ImageDataUri, Base64HasTheTestVectorsOfRfc4648) {
  EXPECT_EQ(base64(bytesOf("")), "");
  EXPECT_EQ(base64(bytesOf("f")), "Zg==");
  EXPECT_EQ(base64(bytesOf("fo")), "Zm8=");
  EXPECT_EQ(base64(bytesOf("foo")), "Zm9v");
  EXPECT_EQ(base64(bytesOf("foob")), "Zm9vYg==");
  EXPECT_EQ(base64(bytesOf("fooba")), "Zm9vYmE=");
  EXPECT_EQ(base64(bytesOf("foobar")), "Zm9vYmFy");
  EXPECT_EQ(base64({255, 255, 254}), "///+");
}

TEST(ImageDataUri, DecodesToTheImage) {
  traffic::CameraImage image{3, 2, 0, {}};
  for (int i = 0; i < 18; ++i) image.rgb.push_back(static_cast<std::uint8_t>(13 * i));
  const std::string uri = pngDataUri(image);
  const std::string head = "data:image/png;base64,";
  ASSERT_EQ(uri.substr(0, head.size()), head);
  const cv::Mat read = cv::imdecode(decoded(uri.substr(head.size())), cv::IMREAD_COLOR);
  ASSERT_EQ(read.cols, 3);
  ASSERT_EQ(read.rows, 2);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      const auto& pixel = read.at<cv::Vec3b>(row, column);  // blue, green, red
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_EQ(pixel[2 - channel], 13 * (3 * (3 * row + column) + channel));
      }
    }
  }
}

TEST(ImageDataUri, RefusesAnImageThatIsNotWhole) {
  EXPECT_THROW(pngDataUri({}), core::InputError);
  EXPECT_THROW(pngDataUri({2, 2, 0, {1, 2, 3}}), core::InputError);
}

}  // namespace
}  // namespace cdiff::record

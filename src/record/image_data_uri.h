// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Camera images inside a page that needs nothing from outside: "data:image/png;base64,..." without
/// loss, JPEG where there are many.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/camera_image.h"

namespace cdiff::record {

/// Whether the image has pixels, as many bytes as its size says.
bool isWhole(const traffic::CameraImage& image);

/// Throws InputError when the image is not whole.
std::string pngDataUri(const traffic::CameraImage& image);

/// JPEG (JFIF), 4:2:0. Throws InputError when the image is not whole.
std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image);

/// RFC 4648, padded, one line.
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace cdiff::record

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/process.h"

namespace cdiff::video {

/// Size [pixels] and frame rate [1/s] of a video.
struct VideoFormat {
  int width = 0;   ///< [pixels], even
  int height = 0;  ///< [pixels], even
  int rate = 0;    ///< frames per second
};

/// Frames (8-bit blue, green, red; row-major from the top left) to an MP4 file: H.264, yuv420p,
/// BT.709, by the program `ffmpeg`, which reads them from a socket, cannot take us down and ends
/// with us.
class VideoEncoder {
 public:
  /// Removes `file`, starts the program and has it write to a temporary file beside. Throws
  /// InputError when the program is not there, SimulatorError when no process can be made.
  VideoEncoder(std::filesystem::path file, const VideoFormat& format);
  /// Ends the program and removes the temporary file when `finish` was not called.
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// `frame` holds height x width x 3 bytes. Throws SimulatorError with the program's own words
  /// when it ended or took nothing for 30 s.
  void write(const std::vector<std::uint8_t>& frame);
  /// Waits for the program and gives the file its name. Throws SimulatorError as `write` does, e.g.
  /// when the disk is full. Call once.
  void finish();

 private:
  void start(const VideoFormat& format);
  void closeInput();
  /// Exit code, 128 + signal where one ended it; kills the program after 60 s.
  int wait();
  void stop();
  [[noreturn]] void fail(const std::string& text);

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  std::unique_ptr<core::GuardedProcess> process_;
  int input_ = -1;                ///< our end of the socket
  core::ProcessOutput messages_;  ///< what the program says of errors
};

}  // namespace cdiff::video

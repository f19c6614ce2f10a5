// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/guarded_process.h"
#include "core/output_folder.h"
#include "record/session_result.h"
#include "session/session_observer.h"

namespace cdiff::video {

// The video of a session, written through ffmpeg while it runs.

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
  /// Removes an earlier video of this name, starts the program and has it write to a temporary file
  /// beside. `longest_pause` is how long it may read nothing [s of wall time]. Throws InputError
  /// when the program is not there or `file` is there and not ours, SimulatorError when no process
  /// can be made.
  VideoEncoder(const std::filesystem::path& file, const VideoFormat& format,
               int longest_pause = 30);
  /// Ends the program and removes the temporary file when `finish` was not called.
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// `frame` holds height x width x 3 bytes. Throws SimulatorError with the program's own words
  /// when it ended, or took nothing for the longest pause, after which it is killed.
  void write(const std::vector<std::uint8_t>& frame);
  /// Waits for the program and gives the file its name. Throws SimulatorError as `write` does, e.g.
  /// when the disk is full. Call once.
  void finish();

 private:
  void start(const VideoFormat& format);
  /// Exit code, 128 + signal where one ended it; kills the program after 60 s.
  int wait();
  void stop();
  [[noreturn]] void fail(const std::string& text);

  std::string partName() const { return name_ + ".part"; }

  core::OutputFolder folder_;
  std::string name_;
  std::filesystem::path file_;
  int longest_pause_;  ///< [s]
  std::unique_ptr<core::GuardedProcess> process_;
  core::FileDescriptor input_;    ///< our end of the socket
  core::ProcessOutput messages_;  ///< error output of the program
};

/// Name of the video in the result folder.
inline constexpr const char* kVideoFile = "session.mp4";
/// Frames per second.
inline constexpr int kVideoRate = 10;
/// Frames with the verdict.
inline constexpr int kVerdictFrames = 20;

/// Makes session.mp4 while a session runs: 1280 x 720 pixels, 10 frames per simulated second; the
/// front view of the CBV nearest to the ego and what ego and CBVs do on the left, the world from
/// above around the ego on the right; two seconds with the verdict at the end. Frames are functions
/// of the session alone.
class SessionVideo : public session::SessionObserver {
 public:
  /// Writes `folder`/session.mp4; an earlier one is removed. `setup` must outlive the video. What
  /// goes wrong here and later is kept in `error`: a video never ends a session.
  SessionVideo(const session::SessionSetup& setup, const std::filesystem::path& folder);
  ~SessionVideo() override;

  /// The front view is that of the CBV nearest to the ego; contacts of the ego stay for 1.5 s.
  void observe(const session::TickRecord& record) override;
  /// Adds the verdict and gives the file its name. Call once, when the result is complete.
  void finish(const record::SessionResult& result);
  /// Why there is no video, naming who must act; empty when all is well.
  const std::string& error() const { return error_; }

 private:
  class Studio;
  std::unique_ptr<Studio> studio_;  ///< nullptr after an error
  std::string error_;
};

}  // namespace cdiff::video

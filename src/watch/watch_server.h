// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "watch/page_access.h"

namespace cdiff::watch {

/// How far a viewer has been told what there is: of each kind of news a number.
struct NewsCursor {
  std::uint64_t frame = 0;
  std::size_t points = 0;
  std::map<int, std::uint64_t> views = {};  ///< tick of the last front view, by slot
  std::uint64_t verdict = 0;
  std::size_t changes = 0;
  std::size_t faults = 0;
  std::uint64_t values = 0;
  std::string state = {};  ///< as it was told
  bool over = false;
};

/// What a server serves; called in its thread alone.
class WatchSource {
 public:
  virtual ~WatchSource() = default;
  /// A document by name ("": the page); nullptr where it is not there yet.
  virtual std::shared_ptr<const std::string> document(const std::string& name) = 0;
  /// A document has been sent whole.
  virtual void delivered(const std::string& name) = 0;
  /// Everything that is new for one viewer, as JSON text; empty: nothing.
  virtual std::string news(NewsCursor& cursor) = 0;
  /// What a viewer sends; `answer` may be called from any thread.
  virtual void take(const std::string& message,
                    std::function<void(const std::string& text)> answer) = 0;
  /// So many viewers are connected now.
  virtual void viewersAre(std::size_t count) = 0;
  /// Several times a second.
  virtual void beat() = 0;
};

/// Limits of a server.
struct WatchLimits {
  std::size_t connections = 64;   ///< at a time; more are closed at once
  std::size_t viewers = 32;       ///< of them, pages with a socket
  std::uint32_t header = 8192;    ///< of a request [bytes]; a body is refused
  std::size_t message = 4096;     ///< of a viewer [bytes]
  std::size_t answers = 64;       ///< that wait for a viewer
  std::size_t messages = 100;     ///< of a viewer in a second; then its next ones wait
  double request_seconds = 5.0;   ///< for a request to be there, and an answer to be taken
  double silence_seconds = 10.0;  ///< after which a viewer that answers no ping is dropped
};

/// Serves a page and its sockets on 127.0.0.1, in a thread of its own. A viewer is asked for when
/// its socket is free, so nothing queues up for a slow one, and nobody waits for it.
class WatchServer {
 public:
  /// `port` 0: a free one. Throws InputError for one that is taken. `source` must outlive the
  /// object.
  WatchServer(std::uint16_t port, WatchSource& source, const WatchLimits& limits = {});
  /// Drops all viewers.
  ~WatchServer();
  WatchServer(const WatchServer&) = delete;
  WatchServer& operator=(const WatchServer&) = delete;

  const PageAccess& access() const;

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

}  // namespace cdiff::watch

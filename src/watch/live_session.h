// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "page/live_page.h"
#include "page/result_writer.h"
#include "session/steered_cbvs.h"
#include "watch/page_command.h"
#include "watch/watch_server.h"

namespace cdiff::watch {

/// Shows a session on live pages while it runs: keeps a copy of the newest tick and of what the
/// charts and tables need, which the server's thread writes for each page when it is ready. The
/// session itself waits for no page.
class LiveSession : public session::SessionObserver, private WatchSource {
 public:
  /// Wall time that a session waits for its first page [s].
  static constexpr double kPatience = 60.0;

  /// Serves the page from now on. `setup` must outlive the object. Throws InputError for a port
  /// that is taken.
  LiveSession(const session::SessionSetup& setup, std::unique_ptr<SessionLink> link,
              std::uint16_t port);
  ~LiveSession() override;

  /// Holds a secret: for the user's terminal and nothing else.
  std::string address() const { return server_->access().address(); }
  /// What the terminal says of it.
  std::string invitation() const;
  /// Before the first tick: pauses the session until a page is open, at most `patience` [s] of wall
  /// time; the first page starts it at real time unless the scenario says at most how fast.
  /// `writer` must outlive the last `observe`.
  void begin(const page::ResultWriter& writer, double patience = kPatience);
  /// After the writer.
  void observe(const session::TickRecord& record) override;
  /// After the result is written: leads the pages to the report, and waits until they have it, at
  /// most five seconds of wall time.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  using Json = nlohmann::ordered_json;

  std::shared_ptr<const std::string> document(const std::string& name) override;
  void delivered(const std::string& name) override;
  std::string news(NewsCursor& cursor) override;
  void take(const std::string& message,
            std::function<void(const std::string& text)> answer) override;
  void viewersAre(std::size_t count) override;
  void beat() override;

  void keepTick(const session::TickRecord& record);
  void keepDecision(const session::TickRecord& record);
  void keepPoint();
  void keepViews(const traffic::TrafficSnapshot& snapshot);
  void keepTexts(const traffic::TrafficSnapshot& snapshot);
  void keepVerdict();
  void noteValues();
  void hold(double patience);
  void start();
  bool addFrame(NewsCursor& cursor, Json& news);
  void addLists(NewsCursor& cursor, Json& news);
  void addState(NewsCursor& cursor, Json& news);

  using EarlyCommand = std::pair<PageCommand, SessionLink::Answer>;

  const session::SessionSetup& setup_;
  const page::ResultWriter* writer_ = nullptr;
  std::unique_ptr<SessionLink> link_;
  std::shared_ptr<const std::string> page_;
  std::atomic<std::size_t> viewers_{0};
  std::atomic<bool> seen_{false};        ///< a page was open
  std::atomic<bool> pace_asked_{false};  ///< by a page

  // Of the session's thread.
  session::SteeredCbvs cbvs_;
  std::shared_ptr<const page::LiveDecision> decision_ = std::make_shared<page::LiveDecision>();
  std::size_t frames_seen_ = 0;    ///< of the writer's timeline
  std::size_t steering_seen_ = 0;  ///< records of the writer's result
  std::map<std::string, double> scores_;
  Clock::time_point next_verdict_;

  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::optional<Clock::time_point> held_until_;
  bool holding_ = false;             ///< `begin` is under way
  std::vector<EarlyCommand> early_;  ///< what pages ask for meanwhile
  std::shared_ptr<const page::LiveTick> tick_;
  std::uint64_t ticks_ = 0;  ///< copied so far
  std::vector<page::LivePoint> points_;
  std::map<int, std::shared_ptr<const record::FrontView>> views_;  ///< by slot
  std::shared_ptr<const Json> verdict_;
  std::uint64_t verdicts_ = 0;
  std::shared_ptr<const Json> values_;
  std::uint64_t values_count_ = 0;
  std::vector<std::vector<std::string>> changes_;
  std::vector<std::vector<std::string>> faults_;
  std::shared_ptr<const std::string> report_;
  bool over_ = false;
  std::size_t reports_delivered_ = 0;

  // Of the server's thread.
  page::LiveWriter pictures_;
  std::uint64_t frame_ = 0;  ///< number of the tick that frame_text_ shows
  std::string frame_text_;

  std::unique_ptr<WatchServer> server_;  ///< ends first
};

}  // namespace cdiff::watch

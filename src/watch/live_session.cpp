// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "watch/live_session.h"

#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/player_parts.h"
#include "record/logs/steering_log.h"

namespace cdiff::watch {
namespace {

constexpr std::size_t kMostRows = 500;      // of the tables of changes and faults
constexpr std::size_t kMostContacts = 200;  // in the picture
constexpr double kVerdictPeriod = 0.5;      // of wall time [s]
constexpr double kVerdictShare = 0.02;      // of wall time that the verdict so far may take
constexpr double kReportPatience = 5.0;     // of wall time [s]
constexpr double kAnswerPatience = 5.0;     // likewise
constexpr const char* kReportName = "report.html";

template <class Value>
std::vector<Value> from(const std::vector<Value>& values, std::size_t& cursor) {
  const std::size_t begin = std::min(cursor, values.size());
  cursor = values.size();
  return {values.begin() + static_cast<std::ptrdiff_t>(begin), values.end()};
}

/// Without what is large and not shown.
planning::PlannedAction shownPart(const planning::PlannedAction& action) {
  planning::PlannedAction shown;
  shown.slot = action.slot;
  shown.vehicle_id = action.vehicle_id;
  shown.rollout = action.rollout;
  shown.guidance = action.guidance;
  return shown;
}

std::string dumped(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

LiveSession::LiveSession(const session::SessionSetup& setup, std::unique_ptr<SessionLink> link,
                         std::uint16_t port)
    : setup_(setup),
      link_(std::move(link)),
      page_(std::make_shared<const std::string>(page::livePage(setup))),
      cbvs_(setup.options()),
      pictures_(setup) {
  noteValues();
  WatchSource& source = *this;
  server_ = std::make_unique<WatchServer>(port, source);
}

LiveSession::~LiveSession() = default;

std::string LiveSession::invitation() const {
  return "watch the session at " + address() + "\n(this computer alone; it begins when the page " +
         "is open, without one in " + core::formatFixed(kPatience, 0) + " s)\n";
}

void LiveSession::begin(const page::ResultWriter& writer, double patience) {
  writer_ = &writer;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    holding_ = true;
  }
  hold(patience);
  if (seen_) start();  // by a page that came before
  std::vector<EarlyCommand> early;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    holding_ = false;
    early.swap(early_);
  }
  for (EarlyCommand& one : early) link_->send(one.first, std::move(one.second));
}

/// Pauses the session until a page starts it; not where the wall clock rules.
void LiveSession::hold(double patience) {
  auto done = std::make_shared<std::promise<bool>>();
  std::future<bool> paused = done->get_future();
  link_->send({}, [done](const std::string& refused) { done->set_value(refused.empty()); });
  const bool answered =
      paused.wait_for(std::chrono::duration<double>(kAnswerPatience)) == std::future_status::ready;
  if (!answered || !paused.get()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  held_until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(patience));
}

void LiveSession::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  if (record.selection != nullptr) {
    for (const cbv::CbvAssignment& one : record.selection->assignments)
      scores_[one.vehicle_id] = one.interaction_score;
  }
  keepTick(record);
  keepPoint();
  keepViews(snapshot);
  keepTexts(snapshot);
  if (viewers_ > 0) keepVerdict();
}

void LiveSession::keepTick(const session::TickRecord& record) {
  keepDecision(record);
  auto tick = std::make_shared<page::LiveTick>();
  tick->snapshot = *record.snapshot;
  tick->decision = decision_;
  const std::lock_guard<std::mutex> lock(mutex_);
  tick_ = std::move(tick);
  ++ticks_;
}

void LiveSession::keepDecision(const session::TickRecord& record) {
  const auto& contacts = writer_->result().timeline.contacts();
  const std::size_t shown = std::min(contacts.size(), kMostContacts);
  if (record.selection == nullptr && shown == decision_->contacts.size()) return;
  auto decision = std::make_shared<page::LiveDecision>(*decision_);
  if (record.selection != nullptr) decision->assignments = record.selection->assignments;
  for (const cbv::CbvAssignment& one : decision->assignments) {
    if (std::find(decision->cbvs.begin(), decision->cbvs.end(), one.vehicle_id) ==
        decision->cbvs.end())
      decision->cbvs.push_back(one.vehicle_id);
  }
  if (record.actions != nullptr) {
    decision->actions.clear();
    for (const planning::PlannedAction& action : *record.actions)
      decision->actions.push_back(shownPart(action));
  }
  for (std::size_t i = decision->contacts.size(); i < shown; ++i)
    decision->contacts.push_back(contacts[i]);
  decision_ = std::move(decision);
}

void LiveSession::keepPoint() {
  const record::Timeline& timeline = writer_->result().timeline;
  if (timeline.frames().size() == frames_seen_) return;
  frames_seen_ = timeline.frames().size();
  const record::TimelineFrame& frame = timeline.frames().back();
  page::LivePoint point{frame.time, {}};
  for (const record::TimelinePose& pose : frame.poses) {
    if (pose.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    const std::string& id = timeline.vehicles()[pose.vehicle].id;
    const bool ego = pose.role == traffic::VehicleRole::kEgo;
    const auto place = std::find(decision_->cbvs.begin(), decision_->cbvs.end(), id);
    const auto order = static_cast<std::size_t>(place - decision_->cbvs.begin());
    const auto score = scores_.find(id);
    point.vehicles.push_back({id, ego ? 0 : page::cbvStyleNumber(order), pose,
                              ego || score == scores_.end() ? -1.0 : score->second});
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  points_.push_back(std::move(point));
}

void LiveSession::keepViews(const traffic::TrafficSnapshot& snapshot) {
  const std::vector<record::FrontView>& views = writer_->result().front_views.views();
  for (auto view = views.rbegin(); view != views.rend() && view->tick == snapshot.tick; ++view) {
    auto copy = std::make_shared<const record::FrontView>(*view);
    const std::lock_guard<std::mutex> lock(mutex_);
    views_[view->slot] = std::move(copy);
  }
}

void LiveSession::keepTexts(const traffic::TrafficSnapshot& snapshot) {
  if (snapshot.steering.empty() && snapshot.faults.empty()) return;
  const std::string time = core::formatFixed(snapshot.time, 2);
  bool steered = false;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const session::SteeringRecord& record :
       from(writer_->result().steering.records(), steering_seen_)) {
    const traffic::SteeringChange& change = record.change;
    steered = cbvs_.concerns(change.what) || steered;
    cbvs_.follow(change);
    if (changes_.size() < kMostRows) {
      changes_.push_back(
          {time, change.by, record::steeringText({record.tick, change, {}}), record.refused});
    }
  }
  for (const traffic::Fault& fault : snapshot.faults) {
    if (faults_.size() < kMostRows) faults_.push_back({time, fault.source, fault.text});
  }
  if (steered) noteValues();
}

/// What the page's controls show.
void LiveSession::noteValues() {
  namespace steered = traffic::steered;
  Json values = {{"profile", cbvs_.value(steered::kProfile)},
                 {"target_speed", cbvs_.value(steered::kTargetSpeed)},
                 {"weights", Json::object()}};
  for (const guidance::WeightedObjective& entry : cbvs_.guidance().objectives)
    values["weights"][entry.name] = core::formatNumber(entry.weight);
  values_ = std::make_shared<const Json>(std::move(values));
  ++values_count_;
}

/// What the rules would find if the session ended by itself now.
void LiveSession::keepVerdict() {
  const Clock::time_point begin = Clock::now();
  if (begin < next_verdict_) return;
  const record::Verdict verdict =
      record::judge(setup_.options(), traffic::SessionStatus::kCompleted, writer_->measures(), {});
  const bool by_hand = writer_->result().steering.byHand();
  auto json = std::make_shared<const Json>(page::LiveWriter::verdict(verdict, by_hand));
  const std::chrono::duration<double> took = Clock::now() - begin;
  const std::chrono::duration<double> rest(std::max(kVerdictPeriod, took.count() / kVerdictShare));
  next_verdict_ = begin + std::chrono::duration_cast<Clock::duration>(rest);
  const std::lock_guard<std::mutex> lock(mutex_);
  verdict_ = std::move(json);
  ++verdicts_;
}

void LiveSession::finish() {
  if (writer_ == nullptr) return;
  std::shared_ptr<const std::string> report;
  try {
    report = std::make_shared<const std::string>(
        core::readFile(writer_->folder() / kReportName, "report"));
  } catch (const core::Error&) {
    // the pages say that there is none
  }
  std::unique_lock<std::mutex> lock(mutex_);
  report_ = std::move(report);
  over_ = true;
  const std::size_t expected = viewers_;
  changed_.wait_for(lock, std::chrono::duration<double>(kReportPatience), [&] {
    return reports_delivered_ >= expected || (viewers_ == 0 && reports_delivered_ > 0);
  });
}

std::shared_ptr<const std::string> LiveSession::document(const std::string& name) {
  if (name != kReportName) return page_;
  const std::lock_guard<std::mutex> lock(mutex_);
  return report_;
}

void LiveSession::delivered(const std::string& name) {
  if (name != kReportName) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++reports_delivered_;
  changed_.notify_all();
}

void LiveSession::viewersAre(std::size_t count) {
  viewers_ = count;
  if (count == 0) return;
  seen_ = true;
  start();
}

/// The first page starts a session that was held for it.
void LiveSession::start() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!held_until_) return;
    held_until_.reset();
  }
  const auto ignore = [](const std::string&) {};
  if (seen_ && !pace_asked_ && setup_.options().at_most <= 0.0) {
    PageCommand real_time;
    real_time.kind = PageCommand::Kind::kPace;
    real_time.pace = 1.0;
    link_->send(real_time, ignore);
  }
  PageCommand resume;
  resume.kind = PageCommand::Kind::kResume;
  link_->send(resume, ignore);
}

void LiveSession::beat() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!held_until_ || Clock::now() < *held_until_) return;
  }
  start();
}

void LiveSession::take(const std::string& message,
                       std::function<void(const std::string& text)> answer) {
  const std::uint64_t number = commandNumber(message);
  const auto reply = [number, answer = std::move(answer)](const std::string& refused) {
    const Json one = {{"id", number}, {"refused", refused}};
    answer(dumped({{"answers", Json::array({one})}}));
  };
  try {
    const PageCommand command = commandFrom(message);
    if (command.kind == PageCommand::Kind::kPace) pace_asked_ = true;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (holding_)
      early_.emplace_back(command, reply);
    else
      link_->send(command, reply);
  } catch (const core::InputError& error) {
    reply(error.what());
  }
}

std::string LiveSession::news(NewsCursor& cursor) {
  Json news = Json::object();
  const bool frame = addFrame(cursor, news);
  addLists(cursor, news);
  addState(cursor, news);
  if (!frame) return news.empty() ? std::string() : dumped(news);
  const std::string rest = dumped(news);
  return R"({"frame":)" + frame_text_ + (news.empty() ? "" : ",") + rest.substr(1);
}

/// Whether there is another frame for the viewer: frame_text_, the same for all of them.
bool LiveSession::addFrame(NewsCursor& cursor, Json& news) {
  std::shared_ptr<const page::LiveTick> tick;
  std::map<int, std::shared_ptr<const record::FrontView>> views;
  std::uint64_t number = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (ticks_ == cursor.frame) return false;
    tick = tick_;
    number = ticks_;
    views = views_;
  }
  if (number != frame_) frame_text_ = dumped(pictures_.frame(*tick));
  frame_ = number;
  cursor.frame = number;
  for (const auto& [slot, view] : views) {
    const std::uint64_t known = view->tick + 1;
    if (cursor.views[slot] == known) continue;
    cursor.views[slot] = known;
    auto shown = pictures_.view(*view);
    if (!shown.is_null())
      news["views"][std::to_string(slot)] = std::move(shown);  // of one long gone
  }
  return true;
}

void LiveSession::addLists(NewsCursor& cursor, Json& news) {
  std::vector<page::LivePoint> points;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    points = from(points_, cursor.points);
    const auto changes = from(changes_, cursor.changes);
    const auto faults = from(faults_, cursor.faults);
    if (!changes.empty()) news["changes"] = changes;
    if (!faults.empty()) news["faults"] = faults;
    if (verdicts_ != cursor.verdict) news["verdict"] = *verdict_;
    cursor.verdict = verdicts_;
    if (values_count_ != cursor.values) news["values"] = *values_;
    cursor.values = values_count_;
    if (over_ && !cursor.over) news["over"] = {{"report", report_ != nullptr}};
    cursor.over = over_;
  }
  for (const page::LivePoint& point : points) news["points"].push_back(pictures_.point(point));
}

void LiveSession::addState(NewsCursor& cursor, Json& news) {
  const std::string run = link_->state();
  const double pace = link_->pace();
  const std::string state = run + " " + core::formatNumber(pace);
  if (state == cursor.state) return;
  cursor.state = state;
  news["run"] = run;
  news["pace"] = pace;
}

}  // namespace cdiff::watch

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "what_if/take_over.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/result_folder.h"
#include "session/closed_loop.h"
#include "session/driven_vehicles.h"

namespace cdiff::what_if {
namespace {

using traffic::TrafficSnapshot;
using traffic::Vehicle;

/// The first of the lines that the two texts do not share, or what stands for it.
std::string lineAt(std::string_view text, std::size_t place) {
  if (place >= text.size()) return "no row";
  const std::size_t before = text.rfind('\n', place);
  const std::size_t begin = place == 0 || before == std::string_view::npos ? 0 : before + 1;
  return std::string(text.substr(begin, text.find('\n', begin) - begin));
}

bool counts(const metrics::EgoContact& contact, const std::string& partner) {
  return contact.partner == partner || contact.ego_side != "rear";
}

}  // namespace

CourseFollower::CourseFollower(const session::SessionSetup& setup, const TakeOver& take_over,
                               std::optional<RecordedPart> recorded)
    : take_over_(take_over),
      recorded_(recorded),
      judged_(&setup.network(), setup.options().protocol.infractions.collision_minimum_speed),
      course_(setup.options().simulation_step) {
  course_.trace = record::kTraceHeader;
}

void CourseFollower::requireSame(const TrafficSnapshot& snapshot, const std::string& rows) const {
  const std::string_view recorded = recorded_->run.rowsAt(snapshot.tick);
  if (rows == recorded) return;
  const auto place = static_cast<std::size_t>(
      std::mismatch(rows.begin(), rows.end(), recorded.begin(), recorded.end()).first -
      rows.begin());
  throw core::Error("'" + recorded_->run.folder().string() +
                    "': the session does not repeat: at tick " + std::to_string(snapshot.tick) +
                    " its trace has '" + lineAt(recorded, place) + "', now it is '" +
                    lineAt(rows, place) +
                    "'; program, machine or files are not those that it ran with: run it again");
}

void CourseFollower::judge(const TrafficSnapshot& snapshot) {
  judged_.observe(snapshot);
  for (; known_ < judged_.contacts().size(); ++known_) {
    const metrics::EgoContact& contact = judged_.contacts()[known_];
    if (contact.tick <= take_over_.tick) continue;
    if (!counts(contact, take_over_.partner)) {
      ++course_.struck_behind;
    } else if (!course_.contact) {
      course_.contact = contact;
      stop_ = true;
    }
  }
}

void CourseFollower::observe(const session::TickRecord& record) {
  const TrafficSnapshot& snapshot = *record.snapshot;
  if (stop_ || snapshot.tick > take_over_.end_tick) return;
  if (snapshot.status == traffic::SessionStatus::kError)
    throw core::SimulatorError(
        "the session broke at tick " + std::to_string(snapshot.tick) + ": " +
        (snapshot.faults.empty() ? "no cause known" : snapshot.faults.back().text));
  if (snapshot.status == traffic::SessionStatus::kInterrupted) return;  // the last tick again
  std::string rows;
  record::appendTraceRows(rows, snapshot);
  if (recorded_ && snapshot.tick <= recorded_->last_tick) requireSame(snapshot, rows);
  course_.trace += rows;
  course_.timeline.observe(snapshot);
  snapshots_.push_back(snapshot);
  judge(snapshot);
  if (snapshot.tick >= take_over_.end_tick) stop_ = true;
}

namespace {

/// Runs a session to where its follower has seen enough.
void runFollowed(const RecordedRun& run, const session::SessionSetup& setup,
                 session::LoopParts parts, CourseFollower& follower) {
  session::ClosedLoop loop(setup, std::move(parts));
  run.requireUnchanged(setup, loop.world().simulatorVersion());
  loop.addObserver(follower);
  loop.run(follower.stop());
}

}  // namespace

RecordedCourse repeatRecorded(const RecordedRun& run, const session::SessionSetup& setup,
                              const TakeOver& take_over) {
  TakeOver all = take_over;
  all.end_tick = std::min(take_over.end_tick, run.lastTick());
  all.tick = all.end_tick;  // nobody takes over, no contact ends it
  CourseFollower follower(setup, all, RecordedPart{run, all.end_tick});
  session::LoopParts parts;
  parts.selector = setup.makeCbvSelector();
  parts.ego_planner = {std::make_unique<RecordedActions>(run), false};
  parts.cbv_planner = {std::make_unique<RecordedActions>(run), false};
  runFollowed(run, setup, std::move(parts), follower);
  return {std::move(follower.snapshots()), std::move(follower.course())};
}

Course driveClosed(const RecordedRun& run, const Driver& driver, const session::SessionSetup& setup,
                   const TakeOver& take_over) {
  CourseFollower follower(setup, take_over, RecordedPart{run, take_over.tick});
  session::LoopParts parts;
  parts.selector = setup.makeCbvSelector();
  parts.ego_planner = {std::make_unique<TakenOverEgo>(run, driver.make(), take_over.tick),
                       driver.sees()};
  parts.cbv_planner = {setup.makeCbvPlanner(), planners::seesImages(setup.options().cbv_planner)};
  if (parts.ego_planner.sees || parts.cbv_planner.sees) parts.cameras.emplace(setup, driver.rigs());
  runFollowed(run, setup, std::move(parts), follower);
  return std::move(follower.course());
}

namespace {

/// The recorded world with another ego in it, tick by tick.
class OpenWorld {
 public:
  OpenWorld(const session::SessionSetup& setup, const TakeOver& take_over,
            const std::vector<TrafficSnapshot>& recorded, double shift)
      : setup_(setup),
        recorded_(recorded),
        partner_(take_over.partner),
        shift_(std::lround(shift / setup.options().simulation_step)),
        ego_(setup.options().vehicle) {
    ego_.addEgo(traffic::kEgoId, setup.egoRoute(), recorded.front().ego()->state);
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      if (recorded[i].find(partner_) != nullptr) last_ = i;
    }
  }

  TrafficSnapshot at(std::uint64_t tick) {
    const std::size_t index = std::min<std::size_t>(tick, recorded_.size() - 1);
    TrafficSnapshot world = recorded_[index];
    const auto beyond = static_cast<double>(tick - index);
    world.tick = tick;
    world.time = static_cast<double>(tick) * setup_.options().simulation_step;
    world.status = traffic::SessionStatus::kRunning;
    world.decision_tick = tick % setup_.ticksPerDecision() == 0;
    world.faults.clear();
    placeOthers(tick, beyond, world);
    world.vehicles.insert(world.vehicles.begin(), egoNow());
    touch(world);
    return world;
  }

  void advance(const std::vector<planning::PlannedAction>& actions) {
    ego_.command(actions);
    ego_.move(setup_.options().simulation_step);
  }

 private:
  /// Straight on with the speed that it has.
  Vehicle ahead(Vehicle vehicle, double ticks) const {
    vehicle.state.position += ticks * setup_.options().simulation_step * vehicle.state.velocity();
    return vehicle;
  }

  std::optional<Vehicle> partnerAt(std::int64_t tick) const {
    if (tick < 0 || partner_.empty()) return std::nullopt;
    const std::size_t index = std::min<std::size_t>(static_cast<std::size_t>(tick), last_);
    const Vehicle* found = recorded_[index].find(partner_);
    if (found == nullptr) return std::nullopt;
    return ahead(*found, static_cast<double>(tick - static_cast<std::int64_t>(index)));
  }

  void placeOthers(std::uint64_t tick, double beyond, TrafficSnapshot& world) const {
    std::vector<Vehicle> others;
    std::optional<Vehicle> partner = partnerAt(static_cast<std::int64_t>(tick) - shift_);
    for (const Vehicle& vehicle : world.vehicles) {
      if (vehicle.role == traffic::VehicleRole::kEgo) continue;
      if (vehicle.id == partner_) {
        if (partner) others.push_back(*partner);
        partner.reset();
      } else {
        others.push_back(ahead(vehicle, beyond));
      }
    }
    if (partner) others.push_back(*partner);
    world.vehicles = std::move(others);
  }

  Vehicle egoNow() const {
    constexpr double kRadius = 5.0;  // [m] from a lane's centerline
    Vehicle ego = ego_.snapshot({}).front();
    const auto near = setup_.network().lanesNear(ego.state.position, ego.state.elevation, kRadius);
    if (!near.empty()) ego.lane_id = setup_.network().lane(near.front().lane).id;
    return ego;
  }

  /// Contacts of the ego; each partner's first.
  void touch(TrafficSnapshot& world) {
    world.contacts.clear();
    for (const traffic::Contact& contact : session::findContacts(world.vehicles, 1).contacts) {
      const std::string& other = contact.first == traffic::kEgoId ? contact.second : contact.first;
      if (touched_.insert(other).second) world.contacts.push_back(contact);
    }
  }

  const session::SessionSetup& setup_;
  const std::vector<TrafficSnapshot>& recorded_;
  std::string partner_;
  std::int64_t shift_;    ///< ticks that the partner is late
  std::size_t last_ = 0;  ///< tick at which the partner was there last
  session::DrivenVehicles ego_;
  std::set<std::string> touched_;
};

}  // namespace

namespace {

/// Before the take-over nothing but a shifted partner may differ.
void requireSameEgo(const TrafficSnapshot& now, const TrafficSnapshot& recorded) {
  const traffic::VehicleState& state = now.ego()->state;
  const traffic::VehicleState& before = recorded.ego()->state;
  if (state.position == before.position && state.heading == before.heading &&
      state.speed == before.speed)
    return;
  throw std::logic_error("the ego is not where it was at tick " + std::to_string(now.tick));
}

}  // namespace

Course driveOpen(const RecordedRun& run, const Driver& driver, const session::SessionSetup& setup,
                 const TakeOver& take_over, const RecordedCourse& recorded, double shift) {
  OpenWorld world(setup, take_over, recorded.snapshots, shift);
  TakenOverEgo ego(run, driver.make(), take_over.tick);
  std::optional<session::VehicleCameras> cameras;
  if (driver.sees()) cameras.emplace(setup, driver.rigs());
  CourseFollower follower(setup, take_over, std::nullopt);
  for (std::uint64_t tick = 0; !follower.stop(); ++tick) {
    const TrafficSnapshot snapshot = world.at(tick);
    if (tick <= take_over.tick) requireSameEgo(snapshot, recorded.snapshots.at(tick));
    session::TickRecord record;
    record.snapshot = &snapshot;
    follower.observe(record);
    std::vector<planning::PlannedAction> actions;
    if (snapshot.decision_tick) {
      auto tasks = session::egoTasks(snapshot, setup.egoRoute(), setup.options().target_speed);
      std::vector<session::SlotImage> images;
      if (cameras) {
        cameras->render(snapshot, *tasks.front().vehicle, traffic::kEgoSlot, images);
        session::attachImages(images, cameras->rigs(), tasks);
      }
      actions = ego.plan(snapshot, tasks);
    }
    world.advance(actions);
  }
  return std::move(follower.course());
}

std::optional<int> latestAvoiding(int earliest, const std::function<bool(int)>& avoids) {
  constexpr int kStride = 5;
  int fails = 0;
  while (fails < earliest) {
    const int next = std::min(fails + kStride, earliest);
    if (avoids(next)) {
      for (int steps = fails + 1; steps < next; ++steps) {
        if (avoids(steps)) return steps;
      }
      return next;
    }
    fails = next;
  }
  return std::nullopt;
}

}  // namespace cdiff::what_if

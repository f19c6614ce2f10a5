// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// One real bag, damaged in every way that is known: what is left is evaluated, what is missing is
// named.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/program.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "node_graph/bags/bag_reader.h"
#include "node_graph/bags/bag_records.h"
#include "node_graph/bags/replay.h"
#include "node_graph/recorded_bag.h"
#include "record/result_folder.h"
#include "std_msgs/Float64.h"
#include "std_msgs/String.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;
using msgs = ::e2e_cdiff::TrafficSnapshot;

/// What observers were shown, as one number.
class Digest : public session::SessionObserver {
 public:
  void observe(const session::TickRecord& record) override {
    const traffic::TrafficSnapshot& snapshot = *record.snapshot;
    text_ += std::to_string(snapshot.tick) + traffic::toText(snapshot.status);
    for (const traffic::Vehicle& vehicle : snapshot.vehicles)
      text_ += vehicle.id + std::to_string(vehicle.state.position.x()) +
               std::to_string(vehicle.state.speed);
    for (const traffic::Fault& fault : snapshot.faults) text_ += fault.text;
    if (record.actions == nullptr) return;
    for (const planning::PlannedAction& action : *record.actions)
      text_ += action.vehicle_id + std::to_string(action.action.throttle);
    if (record.selection != nullptr) text_ += std::to_string(record.selection->assignments.size());
  }
  std::string value() const { return core::sha256(text_); }

 private:
  std::string text_;
};

/// How a bag was taken.
struct Outcome {
  int exit_code = 0;
  std::string text;       ///< the error, or all findings
  std::size_t ticks = 0;  ///< rows of the trace that name a new tick
  nlohmann::json summary;
};

class DamagedBags : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    test::recordSession(folder_->path() / "live",
                        {"cbv_planner=pdm_lite", "protocol.time_limit=20", "verdict.judge=false"});
    bytes_ = core::readFile(bag(), "bag");
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path bag() { return folder_->path() / "live" / "session.bag"; }
  static fs::path damaged() { return folder_->path() / "damaged.bag"; }
  static fs::path results() { return folder_->path() / "results"; }

  static Outcome replay(const fs::path& file) {
    fs::remove_all(results());
    Outcome outcome;
    try {
      const ReplayResult result = replayBag(file, results());
      outcome.exit_code = result.exit_code;
      for (const std::string& finding : result.findings) outcome.text += finding + "\n";
      outcome.summary =
          nlohmann::json::parse(core::readFile(results() / "summary.json", "summary"));
      outcome.ticks = static_cast<std::size_t>(
          std::llround(outcome.summary["simulated_seconds"].get<double>() / 0.05) + 1);
    } catch (const core::InputError& error) {
      outcome.exit_code = 3;
      outcome.text = error.what();
      EXPECT_FALSE(fs::exists(results())) << "something was written for " << error.what();
    }
    return outcome;
  }
  static Outcome replayText(const std::string& bytes) {
    core::writeFileAtomically(damaged(), bytes);
    return replay(damaged());
  }
  static Outcome replayEdited(const test::BagEdit& edit) {
    test::editBag(bag(), damaged(), edit);
    return replay(damaged());
  }
  /// Every snapshot through `change`, which returns whether it stays.
  static Outcome replayWith(const std::function<bool(msgs&)>& change) {
    return replayEdited([&](const rosbag::MessageInstance& message, rosbag::Bag& to) {
      const auto snapshot = message.instantiate<msgs>();
      if (!snapshot) return test::keep(message, to);
      msgs changed = *snapshot;
      if (change(changed)) to.write(message.getTopic(), message.getTime(), changed);
    });
  }
  static bool says(const Outcome& outcome, const std::string& part) {
    return outcome.text.find(part) != std::string::npos;
  }

  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline std::string bytes_;
};

constexpr std::size_t kLastTick = 400;  // 20 s of 0.05 s
constexpr std::size_t kFirstTicks = 2;  // chunk behind those of session and route

TEST_F(DamagedBags, AWholeBagHasNoFindingsAndCopiesOfItNeither) {
  EXPECT_EQ(replay(bag()).exit_code, 0);
  EXPECT_EQ(replay(bag()).text, "");
  const Outcome copy = replayEdited(test::keep);
  EXPECT_EQ(copy.exit_code, 0) << copy.text;
  EXPECT_EQ(copy.ticks, kLastTick + 1);
}

TEST_F(DamagedBags, EveryCompressionOfRosbagIsRead) {
  for (const auto compression : {rosbag::compression::Uncompressed, rosbag::compression::BZ2}) {
    const rosbag::Bag source(bag().string(), rosbag::bagmode::Read);
    rosbag::Bag target(damaged().string(), rosbag::bagmode::Write);
    target.setCompression(compression);
    for (const rosbag::MessageInstance& message : rosbag::View(source)) test::keep(message, target);
    target.close();
    const Outcome outcome = replay(damaged());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_EQ(outcome.ticks, kLastTick + 1);
  }
}

TEST_F(DamagedBags, NothingToEvaluateIsAnErrorThatWritesNothing) {
  const auto expect = [](const Outcome& outcome, const std::string& part) {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_TRUE(says(outcome, part)) << outcome.text << "\nlacks " << part;
    EXPECT_TRUE(says(outcome, "damaged.bag") || says(outcome, "none.bag")) << outcome.text;
  };
  expect(replay(folder_->path() / "none.bag"), "No such file");
  expect(replayText(""), "is empty");
  expect(replayText("not a bag, but a text of some length"), "no ROS bag of format 2.0");
  expect(replayText(bytes_.substr(0, 13)), "holds no session");
  expect(replayText(bytes_.substr(0, 4200)), "holds no session");
  expect(replayEdited([](const auto& message, rosbag::Bag& to) {
           if (message.getTopic() == "/ego/route")
             to.write("/words", message.getTime(), std_msgs::String());
         }),
         "it holds /words (std_msgs/String)");
  expect(replayEdited([](const auto& message, rosbag::Bag& to) {
           if (message.getTopic() != "/session") test::keep(message, to);
         }),
         "holds no session");
  expect(replayEdited([](const auto& message, rosbag::Bag& to) {
           if (message.getTopic() == "/session") test::keep(message, to);
         }),
         "nothing to evaluate");
  expect(replayEdited([](const auto& message, rosbag::Bag& to) {
           to.write(message.getTopic(), message.getTime(), std_msgs::Float64());
         }),
         "topic '/session' holds std_msgs/Float64; expected e2e_cdiff/SessionInfo");
  expect(replayEdited([](const auto& message, rosbag::Bag& to) {
           auto header = boost::make_shared<ros::M_string>(*message.getConnectionHeader());
           if (message.getTopic() == "/traffic") (*header)["md5sum"] = std::string(32, '0');
           to.write(message.getTopic(), message.getTime(), message, header);
         }),
         "recorded it, and its e2e_cdiff/TrafficSnapshot (MD5 sum 0000");
  expect(replayWith([](msgs& snapshot) {
           snapshot.vehicles.push_back(snapshot.vehicles.front());
           snapshot.vehicles.back().id = "ego_2";
           return true;
         }),
         "two egos, 'ego' and 'ego_2'");
}

TEST_F(DamagedBags, AnEncryptedBagIsNamed) {
  // The field that rosbag's AES encryptor adds to the file header.
  const std::string field = "encryptor=rosbag/AesCbcEncryptor";
  const auto number = [](std::uint32_t value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  std::string bytes = bytes_;
  std::uint32_t header_length = 0;
  std::memcpy(&header_length, &bytes[13], sizeof(header_length));
  bytes.insert(17 + header_length, number(static_cast<std::uint32_t>(field.size())) + field);
  bytes.replace(13, 4, number(header_length + 4 + static_cast<std::uint32_t>(field.size())));
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(says(outcome, "is encrypted")) << outcome.text;
}

TEST_F(DamagedBags, MissingTicksAreCountedAndNamed) {
  const Outcome one = replayWith([](const msgs& snapshot) { return snapshot.tick != 41; });
  EXPECT_EQ(one.exit_code, 2);
  EXPECT_EQ(one.text, "tick 41 is missing\n");
  EXPECT_EQ(one.summary["status"], "timed_out");
  EXPECT_EQ(one.summary["faults"].back()["source"], "bag");
  EXPECT_EQ(one.summary["faults"].back()["tick"], 42);
  const Outcome many =
      replayWith([](const msgs& snapshot) { return snapshot.tick < 20 || snapshot.tick > 59; });
  EXPECT_EQ(many.text, "ticks 20 to 59 (40) are missing\n");
  EXPECT_EQ(many.ticks, kLastTick + 1);
  const Outcome begin = replayWith([](const msgs& snapshot) { return snapshot.tick > 4; });
  EXPECT_EQ(begin.text, "ticks 0 to 4 (5) are missing\n");
}

TEST_F(DamagedBags, TwoEgosAtSomeTicksLeaveThese) {
  const Outcome outcome = replayWith([](msgs& snapshot) {
    if (snapshot.tick == 7) {
      snapshot.vehicles.push_back(snapshot.vehicles.front());
      snapshot.vehicles.back().id = "ego_2";
    }
    return true;
  });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "the snapshot of tick 7 cannot be used: it has two egos"))
      << outcome.text;
  EXPECT_TRUE(says(outcome, "tick 7 is missing")) << outcome.text;
}

TEST_F(DamagedBags, TimeAndTicksThatGoBackwardsAreLeftOut) {
  const Outcome tick = replayWith([](msgs& snapshot) {
    if (snapshot.tick == 100) snapshot.tick = 30;
    return true;
  });
  EXPECT_TRUE(says(tick, "the snapshot of tick 30 cannot be used: its time is 5 s")) << tick.text;
  const Outcome both = replayWith([](msgs& snapshot) {
    if (snapshot.tick == 100) {
      snapshot.tick = 30;
      snapshot.time = 1.5;
    }
    return true;
  });
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_TRUE(says(both, "time goes backwards: tick 30 (1.5 s) comes after tick 99")) << both.text;
  EXPECT_TRUE(says(both, "tick 100 is missing")) << both.text;
  EXPECT_EQ(both.ticks, kLastTick + 1);
}

TEST_F(DamagedBags, MissingAnswersAreNamedByTopicAndTick) {
  const Outcome outcome = replayEdited([](const auto& message, rosbag::Bag& to) {
    const auto control = message.template instantiate<::e2e_cdiff::ControlAction>();
    if (control && control->slot == -1 && control->tick == 20) return;
    test::keep(message, to);
  });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.text, "tick 20 lacks ego/control\n");
  const Outcome topic = replayEdited([](const auto& message, rosbag::Bag& to) {
    if (message.getTopic() != "/cbv/selection") test::keep(message, to);
  });
  EXPECT_TRUE(says(topic, "tick 0 lacks cbv/selection")) << topic.text;
  EXPECT_TRUE(says(topic, "more than 100 findings; the rest is not named")) << topic.text;
}

TEST_F(DamagedBags, ATopicOfAnotherTypeIsNamedAndLeftOut) {
  const Outcome outcome = replayEdited([](const auto& message, rosbag::Bag& to) {
    if (message.getTopic() != "/cbv/selection") return test::keep(message, to);
    to.write(message.getTopic(), message.getTime(), std_msgs::Float64());
  });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(
      outcome, "topic '/cbv/selection' holds std_msgs/Float64; expected e2e_cdiff/CbvSelection"))
      << outcome.text;
}

TEST_F(DamagedBags, ASessionThatNeverEndedIsInterrupted) {
  const Outcome outcome = replayWith([](const msgs& snapshot) { return snapshot.tick <= 99; });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.summary["status"], "interrupted");
  EXPECT_EQ(outcome.text,
            "the recording ends at tick 99 (4.95 s) while the session was still running\n");
  EXPECT_EQ(outcome.ticks, 100U);
  EXPECT_EQ(record::readTrace(results() / "trace.csv").back().tick, 99U);
}

TEST_F(DamagedBags, AVehicleWithControlCharactersInItsIdLosesItsTick) {
  const Outcome outcome = replayWith([](msgs& snapshot) {
    if (snapshot.tick == 50) snapshot.vehicles.back().id = "\033[2J";
    return true;
  });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "the snapshot of tick 50 cannot be used")) << outcome.text;
  EXPECT_EQ(core::readFile(results() / "trace.csv", "trace").find('\033'), std::string::npos);
}

TEST_F(DamagedBags, ASecondSessionIsNotMixedIn) {
  const Outcome outcome = replayEdited([](const auto& message, rosbag::Bag& to) {
    test::keep(message, to);
    const auto snapshot = message.template instantiate<msgs>();
    if (!snapshot || snapshot->tick != 50) return;
    ::e2e_cdiff::SessionInfo other;
    other.scenario_yaml = "name: other";
    to.write("/session", message.getTime(), other);
  });
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "a second session begins in it after tick 50")) << outcome.text;
  EXPECT_EQ(outcome.summary["status"], "interrupted");
}

/// Offsets of the bag's chunks: begin of the data and length.
std::vector<std::pair<std::size_t, std::size_t>> chunksOf(const std::string& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> chunks;
  const std::string mark("op=\x05", 4);
  for (std::size_t at = bytes.find(mark); at != std::string::npos; at = bytes.find(mark, at + 1)) {
    const std::size_t length_at = at + mark.size() + 4 + 9;  // the field size=XXXX follows
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + length_at, sizeof(length));
    chunks.emplace_back(length_at + sizeof(length), length);
  }
  return chunks;
}

TEST_F(DamagedBags, ACutOffRecordingGivesAllThatWasWritten) {
  const auto chunks = chunksOf(bytes_);
  ASSERT_GE(chunks.size(), kFirstTicks + 3);
  std::size_t before = 0;
  for (std::size_t i = kFirstTicks + 1; i < chunks.size(); ++i) {
    const Outcome outcome = replayText(bytes_.substr(0, chunks[i].first + chunks[i].second / 2));
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_TRUE(says(outcome, "before its index")) << outcome.text;
    EXPECT_TRUE(says(outcome, "the recording ends at tick ")) << outcome.text;
    EXPECT_EQ(outcome.summary["status"], "interrupted");
    EXPECT_GT(outcome.ticks, before);
    before = outcome.ticks;
  }
}

TEST_F(DamagedBags, ABagThatWasNeverClosedIsReadToItsLastChunk) {
  // As a recorder leaves FILE.active when it is killed: the file header without an index, the last
  // chunk's header without its sizes.
  const auto chunks = chunksOf(bytes_);
  const auto [begin, length] = chunks.back();
  std::string bytes = bytes_.substr(0, begin + length);
  std::memset(&bytes[begin - 4], 0, 4);                     // length of the data
  std::memset(&bytes[begin - 8], 0, 4);                     // decompressed size
  const std::size_t index = bytes.find("index_pos=") + 10;  // of the file header
  std::memset(&bytes[index], 0, 8);
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.text, "its recording was cut off: it has no index\n");
  EXPECT_EQ(outcome.summary["status"], "timed_out");
  EXPECT_EQ(outcome.ticks, kLastTick + 1);
}

TEST_F(DamagedBags, AChunkIsReadToTheSizeThatItsHeaderSays) {
  const auto [begin, length] = chunksOf(bytes_)[kFirstTicks + 1];
  const std::uint32_t said = 1000;
  const ChunkText text = decompressChunk("lz4", bytes_.substr(begin, length), said);
  EXPECT_EQ(text.bytes.size(), said);
  std::string bytes = bytes_;
  std::memcpy(&bytes[begin - 8], &said, sizeof(said));
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "it goes on after 1000 bytes, which its header says it holds"))
      << outcome.text;
}

TEST_F(DamagedBags, OverwrittenBytesLoseTheirChunkAlone) {
  const auto [begin, length] = chunksOf(bytes_)[kFirstTicks + 1];
  std::string bytes = bytes_;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin + length / 2), 64, '\x55');
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "nothing of it is left")) << outcome.text;
  EXPECT_TRUE(says(outcome, ") are missing")) << outcome.text;
  EXPECT_EQ(outcome.summary["status"], "timed_out");
  EXPECT_EQ(outcome.ticks, kLastTick + 1);
}

TEST_F(DamagedBags, OverwrittenFirstTicksLeaveTheSession) {
  const auto chunks = chunksOf(bytes_);
  const auto [begin, length] = chunks[kFirstTicks];
  ASSERT_GT(length, chunks[0].second + chunks[1].second);
  std::string bytes = bytes_;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin + length / 2), 64, '\x55');
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_EQ(outcome.summary["status"], "timed_out");
}

TEST_F(DamagedBags, AnOverwrittenChunkHeaderLosesThatChunkAlone) {
  const auto chunks = chunksOf(bytes_);
  std::string bytes = bytes_;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(chunks[kFirstTicks + 1].first - 30), 20,
              '\xff');
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "are no records of a bag")) << outcome.text;
  EXPECT_EQ(outcome.summary["status"], "timed_out");
}

TEST_F(DamagedBags, AnOverwrittenBeginIsNoHindrance) {
  std::string bytes = bytes_;
  std::fill_n(bytes.begin(), 2000, '\0');
  const Outcome outcome = replayText(bytes);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(says(outcome, "are no records of a bag")) << outcome.text;
  EXPECT_EQ(outcome.summary["status"], "timed_out");
  EXPECT_EQ(outcome.ticks, kLastTick + 1);
}

/// What observers are shown of a bag; the findings, or why there is nothing.
std::pair<std::string, std::string> shown(const fs::path& file) {
  try {
    RecordedSession session(file);
    Digest digest;
    showTicks(session, {&digest});
    std::string findings;
    for (const std::string& finding : session.findings()) findings += finding + "\n";
    return {digest.value(), findings};
  } catch (const core::InputError& error) {
    return {"", error.what()};
  }
}

TEST_F(DamagedBags, TwoHundredRandomDamagesAreNamedOrChangeNothing) {
  constexpr int kCases = 200;
  const std::string whole = shown(bag()).first;
  const core::RandomStream random(1, "damaged_bags");
  int named = 0;
  for (int i = 0; i < kCases; ++i) {
    const auto draw = [&](std::uint32_t what, double below) {
      return static_cast<std::size_t>(below *
                                      random.uniform({static_cast<std::uint64_t>(i), what, 0}, 0));
    };
    std::string bytes = bytes_;
    const double size = static_cast<double>(bytes.size());
    if (i % 2 == 0) {
      bytes.resize(draw(0, size));
    } else {
      const std::size_t length = 1 + draw(1, i % 4 == 1 ? 8.0 : 5000.0);
      const std::size_t at = draw(2, size - static_cast<double>(length));
      for (std::size_t j = at; j < at + length; ++j)
        bytes[j] = static_cast<char>(draw(static_cast<std::uint32_t>(3 + j), 256.0));
    }
    core::writeFileAtomically(damaged(), bytes);
    const auto [digest, findings] = shown(damaged());
    named += !findings.empty();
    EXPECT_TRUE(!findings.empty() || digest == whole) << "case " << i;
  }
  EXPECT_GE(named, kCases / 2);  // all truncations
}

TEST_F(DamagedBags, AReplayThatIsInterruptedLeavesNothing) {
  fs::remove_all(results());
  core::catchStopSignals();
  std::raise(SIGINT);
  EXPECT_THROW(replayBag(bag(), results()), core::Interrupted);
  EXPECT_FALSE(fs::exists(results()));
  core::catchStopSignals();  // takes the request back
  for (const int signal : core::stopSignals()) std::signal(signal, SIG_DFL);
}

}  // namespace
}  // namespace cdiff::node_graph

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Messages with bytes that were overwritten at random: each is refused, or becomes values that a
// session can use. "Million" runs under `scripts/test --nightly`.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <vector>

#include "e2e_cdiff/AckermannCommand.h"
#include "geometry_msgs/Twist.h"
#include "nav_msgs/Path.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/nodes/external_ego.h"
#include "record/sample_session.h"

namespace cdiff::node_graph {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A message whose bytes are overwritten in one to four places, by numbers that nobody expects or
/// by others at random.
class Overwriter {
 public:
  explicit Overwriter(std::uint32_t seed) : random_(seed) {}

  /// False where the bytes are no message of this type.
  template <class Message>
  bool overwrite(const Message& original, Message& changed) {
    Bytes bytes(ros::serialization::serializationLength(original));
    ros::serialization::OStream output(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::serialize(output, original);
    for (std::size_t places = 1 + random_() % 4; places > 0; --places) change(bytes);
    ros::serialization::IStream input(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    try {
      ros::serialization::deserialize(input, changed);
    } catch (const std::exception&) {  // as roscpp, which drops the message
      return false;
    }
    return true;
  }

 private:
  void change(Bytes& bytes) {
    using Limits = std::numeric_limits<double>;
    static const double kNumbers[] = {
        Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), -1.0, 0.0,
        Limits::denorm_min()};
    double number = kNumbers[random_() % std::size(kNumbers)];
    if (random_() % 2 == 0) {
      const std::uint64_t any = std::uint64_t{random_()} << 32 | random_();
      std::memcpy(&number, &any, sizeof(number));
    }
    const std::size_t at = random_() % bytes.size();
    std::memcpy(&bytes[at], &number, std::min(sizeof(number), bytes.size() - at));
  }

  std::mt19937 random_;
};

class FuzzedMessages : public ::testing::Test {
 protected:
  /// A length that was overwritten asks for up to 4 GB of vehicles: it gets 64 MB.
  static void SetUpTestSuite() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{64} << 20);
    const rlimit limit{most, most};  // [byte]
    ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  }
  template <class Message>
  void expectValidControls(const std::string& command, const Message& message, int count) {
    graph_.external_ego = true;
    graph_.ego_command = command;
    ExternalEgo ego(sample_.setup, graph_);
    Overwriter overwriter(1);
    int controls = 0;
    for (int i = 0; i < count; ++i) {
      auto changed = boost::make_shared<Message>();
      if (!overwriter.overwrite(message, *changed)) continue;
      ego.published(test::sampleSnapshot(4));
      const EgoAnswer answer = ego.take(AnyMessage(boost::shared_ptr<const Message>(changed)));
      if (!answer.control) continue;
      ++controls;
      expectValid(*messageAs<msgs::ControlAction>(answer.control));
    }
    EXPECT_GT(controls, 0);
  }
  static void expectValid(const msgs::ControlAction& control) {
    ASSERT_TRUE(control.throttle >= 0.0 && control.throttle <= 1.0) << control.throttle;
    ASSERT_TRUE(control.brake >= 0.0 && control.brake <= 1.0) << control.brake;
    ASSERT_TRUE(control.steer >= -1.0 && control.steer <= 1.0) << control.steer;
  }
  void expectUsableSnapshots(int count) {
    const msgs::TrafficSnapshot message = toMsg(test::sampleSnapshot(4));
    Overwriter overwriter(2);
    int used = 0;
    for (int i = 0; i < count; ++i) {
      msgs::TrafficSnapshot changed;
      if (!overwriter.overwrite(message, changed) || !unusable(changed, 0.05).empty()) continue;
      ++used;
      for (const traffic::Vehicle& vehicle : fromMsg(changed).vehicles) {
        ASSERT_TRUE(vehicle.state.position.allFinite());
        ASSERT_TRUE(std::isfinite(vehicle.state.speed + vehicle.state.heading));
      }
    }
    EXPECT_GT(used, 0);
    EXPECT_LT(used, count);
  }
  /// A third of `count` of each kind. Actions come as they are said; the world replaces those that
  /// are not valid.
  void expectAll(int count) {
    msgs::AckermannCommand ackermann;
    ackermann.tick = 4;
    ackermann.speed = 8.0;
    expectValidControls("ackermann", ackermann, count / 3);
    geometry_msgs::Twist twist;
    twist.linear.x = 5.0;
    expectValidControls("cmd_vel", twist, count / 3);
    expectUsableSnapshots(count / 3);
  }

  test::SampleSetup sample_;
  SessionGraph graph_;
};

TEST_F(FuzzedMessages, ThirtyThousandAreRefusedOrUsable) { expectAll(30000); }
TEST_F(FuzzedMessages, MillionAreRefusedOrUsable) { expectAll(1000000); }

}  // namespace
}  // namespace cdiff::node_graph

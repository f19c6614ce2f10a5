// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <vector>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/road_network.h"
#include "map/import/network_import.h"
#include "support/error_text.h"
#include "support/own_cache.h"
#include "support/real_data.h"

namespace cdiff::map {
namespace {

namespace fs = std::filesystem;

using test::errorOf;

/// A folder of its own for inputs and for the cache.
class NetworkImport : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) const {
    core::writeFileAtomically(folder_ / name, content);
    return (folder_ / name).string();
  }
  const test::TemporaryFolder own_folder_;
  const test::OwnCache cache_;
  const fs::path folder_ = own_folder_.path();
};

TEST_F(NetworkImport, LeavesAKnownNetworkAsItIs) {
  const std::string text =
      "<net><edge id=\"a\"><lane id=\"a_0\" allow=\"bus passenger\" shape=\"0,0 "
      "1,0\"/></edge></net>";
  const std::string file = write("known.net.xml", text);
  const ImportedNetwork network = importNetwork(file);
  EXPECT_EQ(network.file, fs::path(file));
  EXPECT_EQ(network.source, fs::path(file));
  EXPECT_EQ(network.text, text);
  EXPECT_EQ(network.source_sha256, core::sha256(text));
  EXPECT_TRUE(network.changes.empty());
}

TEST_F(NetworkImport, DropsUnknownClassesAndNothingElse) {
  const std::string file = write(
      "new.net.xml",
      "<?xml version=\"1.0\"?>\n<!-- allow=\"drone\" -->\n<net>\n"
      "  <type id=\"x\"\n        disallow=\"pedestrian  drone ship\" width=\"3\"/>\n"
      "  <edge id=\"drone\"><lane id=\"1\" allow=\"scooter\"/><lane id=\"2\" disallow='subway'/>\n"
      "  <lane id=\"3\" allow=\"bus drone taxi\" disallow=\"\"/><lane allow=\"drone\" "
      "disallow=\"bus\"/>\n"
      "  <lane allow=\"scooters\"/></edge>\n</net>\n");
  const ImportedNetwork network = importNetwork(file);
  EXPECT_EQ(network.text,
            "<?xml version=\"1.0\"?>\n<!-- allow=\"drone\" -->\n<net>\n"
            "  <type id=\"x\"\n        disallow=\"pedestrian ship\" width=\"3\"/>\n"
            "  <edge id=\"drone\"><lane id=\"1\" disallow=\"all\"/><lane id=\"2\"/>\n"
            "  <lane id=\"3\" allow=\"bus taxi\" disallow=\"\"/><lane disallow=\"all\"/>\n"
            "  <lane allow=\"scooters\"/></edge>\n</net>\n");
  ASSERT_EQ(network.changes.size(), 1u);
  EXPECT_EQ(
      network.changes[0],
      "removed the vehicle classes subway scooter drone from 5 attributes: SUMO 1.15 does not "
      "know them");
}

TEST_F(NetworkImport, WritesTheCacheOnce) {
  const std::string file = write("new.net.xml", "<net><lane allow=\"bus drone\"/></net>");
  const ImportedNetwork first = importNetwork(file);
  EXPECT_EQ(first.file.parent_path(), cache_.path() / "networks");
  EXPECT_EQ(core::readFile(first.file, "cached network"), first.text);
  const auto written = fs::last_write_time(first.file);
  fs::permissions(first.file.parent_path(), fs::perms::owner_read | fs::perms::owner_exec);
  const ImportedNetwork second = importNetwork(file);
  fs::permissions(first.file.parent_path(), fs::perms::owner_all);
  EXPECT_EQ(second.file, first.file);
  EXPECT_EQ(second.text, first.text);
  EXPECT_EQ(second.changes, first.changes);
  EXPECT_EQ(fs::last_write_time(first.file), written);
  core::writeFileAtomically(first.file, "damaged");
  EXPECT_EQ(core::readFile(importNetwork(file).file, "cached network"), first.text);
}

TEST_F(NetworkImport, NamesWhatIsWrong) {
  const auto expectError = [](const std::string& source, const std::string& part) {
    const std::string message = errorOf([&] { importNetwork(source); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expectError("", "no network was given");
  expectError((folder_ / "none.net.xml").string(), "none.net.xml' does not exist");
  expectError("/dev/null", "network '/dev/null' is no regular file");
  expectError("no_such_network", "network 'no_such_network' is neither a file nor shipped");
  expectError(write("text.net.xml", "hello"), "no <net> element");
  expectError(write("packed.net.xml", "\x1f\x8b\x08 <net"), "is compressed");
  expectError(write("empty.xodr", "<a/>"), "no <OpenDRIVE> element");
  expectError(write("typed.xodr", "<!DOCTYPE a SYSTEM \"/dev/zero\"><OpenDRIVE/>"), "<!DOCTYPE>");
  std::string nested;
  for (int level = 0; level < 100'000; ++level) nested += "<userData>";
  for (int level = 0; level < 100'000; ++level) nested += "</userData>";
  expectError(write("deep.xodr", "<OpenDRIVE>" + nested + "</OpenDRIVE>"), "100001 levels deep");
  expectError(folder_.string(), "is a folder");
}

constexpr const char* kStraightRoad = R"(<?xml version="1.0"?>
<OpenDRIVE><header revMajor="1" revMinor="4" name="" version="1" north="0" south="0" east="0" west="0"/>
<road name="r" length="100" id="1" junction="-1"><link/>
<planView><geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView>
<elevationProfile><elevation s="0" a="2" b="0" c="0" d="0"/></elevationProfile>
<lanes><laneSection s="0"><center><lane id="0" type="none" level="false"/></center>
<right><lane id="-1" type="driving" level="false"><link/>
<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
</road></OpenDRIVE>)";

// netconvert builds a road on it, or an assertion of its own ends it.
TEST_F(NetworkImport, RefusesNumbersThatAreNone) {
  for (const std::string number : {"nan", "-inf", "1e999"}) {
    std::string text = kStraightRoad;
    text.replace(text.find("hdg=\"0\""), 7, "hdg=\"" + number + "\"");
    const std::string message = errorOf([&] { importNetwork(write("wrong.xodr", text)); });
    EXPECT_NE(message.find("has '" + number + "' for 'hdg' of <geometry>; a finite number"),
              std::string::npos)
        << message;
  }
}

TEST_F(NetworkImport, ConvertsOpenDrive) {
  const ImportedNetwork network = importNetwork(write("road.xodr", kStraightRoad));
  ASSERT_EQ(network.changes.size(), 1u);
  EXPECT_EQ(network.changes[0], "converted from OpenDRIVE with netconvert");
  const RoadNetwork read = RoadNetwork::fromText(network.text, "road");
  ASSERT_EQ(read.lanes().size(), 1u);
  EXPECT_NEAR(read.lane(0).centerline.length(), 100.0, 0.1);
  EXPECT_NEAR(read.lane(0).width, 3.5, 1e-9);
  EXPECT_NEAR(read.lane(0).centerline.pointAt(50.0).z(), 2.0, 1e-9);
  const auto written = fs::last_write_time(network.file);
  EXPECT_EQ(importNetwork((folder_ / "road.xodr").string()).text, network.text);
  EXPECT_EQ(fs::last_write_time(network.file), written);
}

TEST_F(NetworkImport, OnlyOpenDriveOfOursKeepsItsCoordinates) {
  std::string text = kStraightRoad;
  text.replace(text.find("x=\"0\""), 5, "x=\"-40\"");
  const auto offsetOf = [&](const std::string& name) {
    return RoadNetwork::fromText(importNetwork(write(name, text)).text, name).netOffset();
  };
  EXPECT_EQ(offsetOf("foreign.xodr"), Eigen::Vector2d(40.0, 0.0));
  text.insert(text.find("revMajor"), "vendor=\"e2e_cdiff\" ");
  EXPECT_EQ(offsetOf("ours.xodr"), Eigen::Vector2d(0.0, 0.0));
}

TEST_F(NetworkImport, LanesWithoutALimitGetThatOfTheirRoad) {
  const auto limitOf = [&](const std::string& type) {
    std::string text = kStraightRoad;
    const ImportedNetwork network =
        importNetwork(write("typed.xodr", text.insert(text.find("<planView>"), type)));
    return RoadNetwork::fromText(network.text, "typed").lane(0).speed_limit;
  };
  EXPECT_NEAR(limitOf(R"(<type s="0" type="motorway"/>)"), 130.0 / 3.6, 0.01);
  EXPECT_NEAR(limitOf(R"(<type s="0" type="rural"/>)"), 100.0 / 3.6, 0.01);
  EXPECT_NEAR(limitOf(R"(<type s="0" type="town"/>)"), 50.0 / 3.6, 0.01);
  EXPECT_NEAR(limitOf(R"(<type s="0" type="town"/><type s="90" type="motorway"/>)"), 50.0 / 3.6,
              0.01);
  EXPECT_NEAR(limitOf(R"(<type s="0" type="motorway"><speed max="80" unit="km/h"/></type>)"),
              80.0 / 3.6, 0.01);
}

TEST_F(NetworkImport, SaysThatItGaveALimit) {
  std::string text = kStraightRoad;
  text.insert(text.find("<planView>"), R"(<type s="0" type="motorway"/>)");
  EXPECT_EQ(importNetwork(write("typed.xodr", text)).changes.size(), 2u);
}

// netconvert splits names at commas, and puts variables of the environment into them.
TEST_F(NetworkImport, ConvertsAFileWhateverItsName) {
  for (const std::string name : {"a,b.xodr", "${HOME}.xodr"}) {
    const std::string content = std::string(kStraightRoad) + "<!-- " + name + " -->";
    const ImportedNetwork network = importNetwork(write(name, content));
    EXPECT_EQ(RoadNetwork::fromText(network.text, name).lanes().size(), 1u);
  }
}

/// Changes that a cache may suffer; each gets the file of a converted network.
const std::vector<std::function<void(const fs::path&)>> kDamages = {
    [](const fs::path& file) { core::writeFileAtomically(file, ""); },
    [](const fs::path& file) { core::writeFileAtomically(file, "<net/>"); },
    [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) - 1); },
    [](const fs::path& file) {
      std::string other = core::readFile(file, "network");
      other.replace(other.find("speed="), 6, "Speed=");
      core::writeFileAtomically(file, other);
    },
    [](const fs::path& file) { fs::remove(file.string() + ".sha256"); },
    [](const fs::path& file) { core::writeFileAtomically(file.string() + ".sha256", ""); },
    [](const fs::path& file) {
      fs::remove(file);
      EXPECT_EQ(::mkfifo(file.c_str(), 0600), 0);
    }};

TEST_F(NetworkImport, ADamagedCacheIsMadeAgain) {
  const std::string source = write("road.xodr", kStraightRoad);
  const ImportedNetwork first = importNetwork(source);
  ASSERT_FALSE(first.text.empty());
  for (std::size_t i = 0; i < kDamages.size(); ++i) {
    kDamages[i](first.file);
    const ImportedNetwork again = importNetwork(source);
    EXPECT_EQ(again.text, first.text) << i;
    EXPECT_EQ(again.file, first.file) << i;
    EXPECT_EQ(core::readFile(again.file, "cached network"), first.text) << i;
    const auto written = fs::last_write_time(again.file);
    EXPECT_EQ(importNetwork(source).text, first.text) << i;
    EXPECT_EQ(fs::last_write_time(again.file), written) << i << ": it is trusted again";
  }
}

TEST_F(NetworkImport, ALinkInTheCacheIsNotWrittenThrough) {
  const std::string source = write("road.xodr", kStraightRoad);
  const ImportedNetwork first = importNetwork(source);
  const std::string notes = write("notes", "mine");
  fs::remove(first.file);
  fs::create_symlink(notes, first.file);
  EXPECT_EQ(importNetwork(source).text, first.text);
  EXPECT_EQ(core::readFile(notes, "notes"), "mine");
  EXPECT_FALSE(fs::is_symlink(first.file));
}

TEST_F(NetworkImport, ProcessesThatConvertAtOnceAllGetTheNetwork) {
  const std::string source = write("road.xodr", kStraightRoad);
  constexpr int kProcesses = 4;
  std::vector<pid_t> children;
  for (int i = 0; i < kProcesses; ++i) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    ::alarm(60);
    int wrong = 0;
    try {
      const ImportedNetwork network = importNetwork(source);
      wrong = core::readFile(network.file, "network") == network.text ? 0 : 1;
    } catch (const std::exception&) {
      wrong = 2;
    }
    ::_exit(wrong);
  }
  for (const pid_t child : children) {
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  const ImportedNetwork network = importNetwork(source);
  EXPECT_EQ(core::readFile(network.file.string() + ".sha256", "checksum"),
            core::sha256(network.text) + "\n");
}

// Three nodes 215 m apart on a road, and one from the middle.
constexpr const char* kStreetMap = R"(<?xml version="1.0"?>
<osm version="0.6"><bounds minlat="50.0" minlon="8.0" maxlat="50.01" maxlon="8.01"/>
<node id="1" lat="50.0010" lon="8.0010"/><node id="2" lat="50.0010" lon="8.0040"/>
<node id="3" lat="50.0010" lon="8.0070"/><node id="4" lat="50.0030" lon="8.0040"/>
<way id="10"><nd ref="1"/><nd ref="2"/><nd ref="3"/><tag k="highway" v="secondary"/>
<tag k="lanes" v="4"/></way>
<way id="11"><nd ref="2"/><nd ref="4"/><tag k="highway" v="residential"/></way>
<way id="12"><nd ref="1"/><nd ref="4"/><tag k="highway" v="footway"/></way>
</osm>)";

// netconvert writes its own configuration into the comment of a network that it makes.
TEST_F(NetworkImport, ANetworkMadeOfAMapIsASumoNetwork) {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<!-- generated: <osm-files value=\"a.osm\"/> <OpenDRIVE -->\n"
      "<net><edge id=\"a\"><lane id=\"a_0\" allow=\"passenger\" shape=\"0,0 1,0\"/></edge></net>";
  EXPECT_EQ(importNetwork(write("made.net.xml", text)).text, text);
}

TEST_F(NetworkImport, ConvertsOpenStreetMapWithTheTypeMapOfThePackage) {
  const ImportedNetwork network = importNetwork(write("town.osm", kStreetMap));
  ASSERT_EQ(network.changes.size(), 1u);
  EXPECT_EQ(network.changes[0], "converted from OpenStreetMap with netconvert");
  const RoadNetwork read = RoadNetwork::fromText(network.text, "town");
  // Two stretches of the road and one side street, both ways each; the footway is no road.
  EXPECT_EQ(read.edgeIds().size(), 6U);
  const auto lanesOf = [&](const std::string& edge) { return read.lanesOfEdge(edge); };
  ASSERT_EQ(lanesOf("10#0").size(), 2U);  // four lanes, two each way
  EXPECT_NEAR(read.lane(lanesOf("10#0")[0]).speed_limit, 13.89, 1e-9);
  ASSERT_EQ(lanesOf("-11").size(), 1U);
  EXPECT_NEAR(read.lane(lanesOf("-11")[0]).speed_limit, 8.33, 1e-9);
  EXPECT_TRUE(read.lane(lanesOf("-11")[0]).routable);
}

TEST_F(NetworkImport, QuotesNetconvert) {
  const std::string message =
      errorOf([&] { importNetwork(write("bad.xodr", "<OpenDRIVE><road")); });
  EXPECT_NE(message.find("netconvert could not convert"), std::string::npos) << message;
  EXPECT_NE(message.find("Error"), std::string::npos) << message;  // netconvert's own word
  EXPECT_TRUE(fs::is_empty(cache_.path() / "networks"));
}

TEST_F(NetworkImport, FindsShippedNetworks) {
  const ImportedNetwork network = importNetwork("crossing_district");
  EXPECT_EQ(network.file.filename(), "crossing_district.net.xml");
  EXPECT_FALSE(RoadNetwork::fromText(network.text, "shipped").lanes().empty());
  const std::string message = errorOf([] { importNetwork("crossing_distrikt"); });
  EXPECT_NE(message.find("the nearest shipped name is 'crossing_district'"), std::string::npos)
      << message;
}

TEST_F(NetworkImport, SumoLoadsEveryRealNetwork) {
  for (const std::string name : {"carla_towns/Town01", "carla_towns/Town03", "carla_towns/Town04",
                                 "carla_towns/Town05", "resco/cologne1", "resco/ingolstadt1"}) {
    const fs::path source = test::realData(name + ".net.xml");
    CDIFF_SKIP_WITHOUT(source);
    const ImportedNetwork network = importNetwork(source.string());
    EXPECT_EQ(network.changes.empty(), name.rfind("resco", 0) == 0) << name;
    const std::string command =
        "SUMO_HOME=/usr/share/sumo sumo --end 1 --no-step-log "
        "--xml-validation never -n '" +
        network.file.string() + "' > '" + (folder_ / "log").string() + "' 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << core::readFile(folder_ / "log", "log");
  }
}

}  // namespace
}  // namespace cdiff::map

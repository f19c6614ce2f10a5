// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/sumo_input_rules.h"
#include "support/error_text.h"
#include "support/real_data.h"

namespace cdiff::simulation {
namespace {

namespace fs = std::filesystem;

using test::errorOf;

std::string demandError(const std::string& text) {
  return errorOf([&] { requireHarmlessDemand(text, "demand file 'a.rou.xml'"); });
}

std::string networkError(const std::string& text) {
  return errorOf([&] { requireHarmlessNetwork(text, "network 'a.net.xml'"); });
}

/// A demand with a parameter in its third line.
std::string withParameter(const std::string& key) {
  return "<routes>\n<vType id=\"t\">\n<param key=\"" + key + "\" value=\"x\"/></vType></routes>";
}

TEST(SumoInputRules, AParameterThatMayNameAFileIsRefusedByKeyAndLine) {
  for (const std::string key : {"device.ssm.file",
                                "device.driverstate.debugFILE",
                                "has.ssm.device",
                                "device.toc.file",
                                "has.toc.device",
                                "has.fcd.device",
                                "has.emissions.device",
                                "has.tripinfo.device",
                                "has.battery.device",
                                "has.elechybrid.device",
                                "has.btsender.device",
                                "has.btreceiver.device",
                                "has.vehroute.device",
                                "device.rerouting.output",
                                "device.taxi.dispatch-algorithm.output",
                                "device.future.file",
                                "has.future.device",
                                "tripinfo-output",
                                "log",
                                "outputFile",
                                "device&#46;ssm.file"}) {
    const std::string error = demandError(withParameter(key));
    EXPECT_NE(error.find("'a.rou.xml', line 3: <param key=\""), std::string::npos)
        << key << ": " << error;
  }
}

TEST(SumoInputRules, ParametersOfDrivingAreTaken) {
  for (const std::string key :
       {"has.rerouting.device", "device.rerouting.period", "device.rerouting.probability",
        "has.driverstate.device", "device.driverstate.initialAwareness", "has.bluelight.device",
        "laneChangeModel.lcStrategic", "junctionModel.ignoreIDs", "vehicleMass", "profile", "note",
        "catalog"}) {
    EXPECT_EQ(demandError(withParameter(key)), "no error") << key;
  }
}

TEST(SumoInputRules, AnElementThatADemandDoesNotNeedIsRefused) {
  for (const std::string element : {"include",
                                    "configuration",
                                    "input",
                                    "output",
                                    "inductionLoop",
                                    "e1Detector",
                                    "instantInductionLoop",
                                    "laneAreaDetector",
                                    "e2Detector",
                                    "entryExitDetector",
                                    "e3Detector",
                                    "edgeData",
                                    "laneData",
                                    "timedEvent",
                                    "calibrator",
                                    "routeProbe",
                                    "vTypeProbe",
                                    "variableSpeedSign",
                                    "rerouter",
                                    "additional",
                                    "tlLogic",
                                    "edge",
                                    "somethingNew"}) {
    const std::string error = demandError("<routes>\n<" + element + " id=\"x\"/></routes>");
    EXPECT_NE(error.find("line 2: <" + element + ">"), std::string::npos) << error;
  }
  EXPECT_NE(demandError("<include href=\"b\"/><routes/>").find("<include>"), std::string::npos);
  EXPECT_NE(demandError("<additional/>").find("<additional>"), std::string::npos);
}

TEST(SumoInputRules, AnAttributeThatMayNameAFileIsRefused) {
  for (const std::string attribute : {"file", "output", "outfile", "dest", "log", "logFile", "href",
                                      "fcd-output", "outputFile"}) {
    const std::string error =
        demandError("<routes>\n<vehicle id=\"x\" " + attribute + "=\"b\"/></routes>");
    EXPECT_NE(error.find("line 2: <vehicle " + attribute + "="), std::string::npos) << error;
  }
  EXPECT_EQ(demandError("<routes><vType id=\"t\" imgFile=\"car.png\"/></routes>"), "no error");
}

TEST(SumoInputRules, PeopleContainersAndFlowsAreTaken) {
  EXPECT_EQ(
      demandError("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- <include/> -->"
                  "<routes><vTypeDistribution id=\"d\"><vType id=\"t\"><carFollowing-IDM/></vType>"
                  "</vTypeDistribution><route id=\"r\" edges=\"a\"/><interval begin=\"0\">"
                  "<flow id=\"f\"><route edges=\"a\"/><stop lane=\"a_0\"/></flow></interval>"
                  "<person id=\"p\" depart=\"0\"><walk/><ride/><personTrip/></person>"
                  "<personFlow id=\"q\"/><container id=\"c\"><transport/><tranship/></container>"
                  "<trip id=\"u\"/><vehicle id=\"v\"><routeDistribution/></vehicle></routes>"),
      "no error");
}

// What SUMO reads and a reader of plain XML does not see.
TEST(SumoInputRules, HiddenElementsAreRefused) {
  EXPECT_NE(demandError("<!DOCTYPE routes [<!ENTITY e '<include/>'>]><routes>&e;</routes>")
                .find("<!DOCTYPE>"),
            std::string::npos);
  EXPECT_NE(demandError("<?xml version=\"1.0\" encoding=\"UTF-7\"?><routes>+ADw-include/+AD4-"
                        "</routes>")
                .find("utf-7"),
            std::string::npos);
  EXPECT_NE(demandError(std::string("<routes>\0<include/></routes>", 27)).find("zero byte"),
            std::string::npos);
  // SUMO writes before it comes to the fault.
  EXPECT_NE(demandError("<routes><include href=\"b\"/><").find("<include>"), std::string::npos);
  EXPECT_NE(demandError("<routes>\n<vehicle").find("line 2: not XML"), std::string::npos);
}

TEST(SumoInputRules, WhatIsNotPlainXmlFromTheFirstLetterToTheLastIsRefused) {
  const std::string demand = "<routes></routes>";
  EXPECT_EQ(demandError("\xEF\xBB\xBF \n" + demand + "\n"), "no error");
  // A packed stream, which SUMO unpacks and pugixml skips.
  EXPECT_NE(demandError("x\x9c packed" + demand), "no error");
  EXPECT_NE(demandError(demand + "packed"), "no error");
  EXPECT_NE(demandError("<routes>\x01</routes>"), "no error");
  EXPECT_NE(networkError("x\x9c packed<net></net>"), "no error");
  EXPECT_NE(demandError(""), "no error");
}

TEST(SumoInputRules, DeepNestingIsRefused) {
  std::string text = "<routes>";
  for (int i = 0; i < 200000; ++i) text += "<param>";
  EXPECT_NE(demandError(text).find("line 1: <param>"), std::string::npos);
}

TEST(SumoInputRules, ANetworkHoldsRoadsAlone) {
  EXPECT_EQ(networkError("<net><edge id=\"a\"><lane id=\"a_0\"><param key=\"origId\" value=\"1\"/>"
                         "</lane></edge><tlLogic type=\"static\"><phase/>"
                         "<param key=\"linkSignalID:1\" value=\"x\"/></tlLogic></net>"),
            "no error");
  for (const std::string element : {"inductionLoop", "include", "vType", "timedEvent", "vehicle",
                                    "edgeData", "routes", "somethingNew"}) {
    const std::string error = networkError("<net>\n<" + element + " id=\"x\"/></net>");
    EXPECT_NE(error.find("'a.net.xml', line 2: <" + element + ">"), std::string::npos) << error;
  }
  EXPECT_NE(networkError("<net><tlLogic type=\"actuated\">\n<param key=\"file\" value=\"x\"/>"
                         "</tlLogic></net>")
                .find("line 2: <param key=\"file\">"),
            std::string::npos);
  EXPECT_NE(networkError("<net><tlLogic type=\"swarm\"/></net>").find("swarm"), std::string::npos);
}

TEST(SumoInputRules, APathThatSumoTakesApartIsRefused) {
  EXPECT_NO_THROW(requirePlainPath("/home/me/a b;%41$.rou.xml", "demand"));
  EXPECT_THROW(requirePlainPath("/home/me/a,b.rou.xml", "demand"), core::InputError);
  EXPECT_THROW(requirePlainPath("/home/me/${HOME}.rou.xml", "demand"), core::InputError);
}

TEST(SumoInputRules, RealDemandsAndNetworksAreTaken) {
  for (const std::string name : {"resco/cologne1", "resco/ingolstadt1"}) {
    const fs::path demand = test::realData(name + ".rou.xml");
    CDIFF_SKIP_WITHOUT(demand);
    requireHarmlessDemand(core::readFile(demand, "demand"), demand.string());
  }
  for (const std::string name : {"carla_towns/Town01", "carla_towns/Town03", "carla_towns/Town04",
                                 "carla_towns/Town05", "resco/cologne1", "resco/ingolstadt1"}) {
    const fs::path network = test::realData(name + ".net.xml");
    CDIFF_SKIP_WITHOUT(network);
    requireHarmlessNetwork(core::readFile(network, "network"), network.string());
  }
}

TEST(SumoInputRules, ShippedDemandsAndNetworksAreTaken) {
  int demands = 0;
  int networks = 0;
  for (const char* folder : {"networks", "config"}) {
    for (const auto& entry : fs::recursive_directory_iterator(core::shareFolder() / folder)) {
      const std::string name = entry.path().filename().string();
      if (name.find(".rou.xml") != std::string::npos) {
        ++demands;
        requireHarmlessDemand(core::readFile(entry.path(), "demand"), name);
      } else if (name.find(".net.xml") != std::string::npos) {
        ++networks;
        requireHarmlessNetwork(core::readFile(entry.path(), "network"), name);
      }
    }
  }
  EXPECT_GE(demands, 4);
  EXPECT_GE(networks, 40);
}

}  // namespace
}  // namespace cdiff::simulation

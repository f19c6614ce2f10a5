// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "inference/safetensors.h"
#include "inference/weight_file_text.h"

namespace cdiff::inference {
namespace {

using test::floatBytes;
using test::littleEndian;
using test::weightFile;

/// Two floats; what the sound file holds as tensor "a" of shape [2].
const char kData[] = "\x00\x00\x80\x3F\x00\x00\x00\x40";

std::string data() { return {kData, 8}; }

/// Header entry of a tensor.
std::string entry(const std::string& name, const std::string& type, const std::string& shape,
                  const std::string& offsets) {
  return "\"" + name + "\":{\"dtype\":\"" + type + "\",\"shape\":" + shape +
         ",\"data_offsets\":" + offsets + "}";
}

/// File of these entries with the right checksum.
std::string fileOf(const std::string& entries, const std::string& content = data()) {
  return weightFile(
      "{\"__metadata__\":{\"sha256\":\"" + core::sha256(content) + "\"}," + entries + "}", content);
}

std::string soundFile() { return fileOf(entry("a", "F32", "[2]", "[0,8]")); }

/// Reads a file that must hold exactly tensor "a" of shape [2].
SafetensorsFile readPair(const std::filesystem::path& file) {
  return readSafetensors(file, [](const std::map<std::string, std::string>&) {
    return std::vector<inference::TensorShape>{{"a", {2}}};
  });
}

struct Fault {
  const char* name;
  std::string bytes;
  const char* expected;  ///< part of the error
};

std::vector<Fault> lengthFaults() {
  const std::uint64_t big = std::uint64_t{1} << 63;
  return {
      {"empty", "", "truncated: 0 bytes"},
      {"seven bytes", std::string(7, 'x'), "truncated: 7 bytes"},
      {"header of no bytes", weightFile("", ""), "does not begin with '{'"},
      {"header beyond the file", littleEndian(1000) + "{}", "header of 1000 bytes is announced"},
      {"header of 2^63 bytes", littleEndian(big) + "{}", "length 9223372036854775808 exceeds"},
      {"header of 2^64 - 1 bytes", littleEndian(~std::uint64_t{0}) + "{}",
       "length 18446744073709551615 exceeds"},
      {"header of 8 MiB + 1", littleEndian((8u << 20) + 1) + std::string((8u << 20) + 1, ' '),
       "length 8388609 exceeds the limit of 8388608"}};
}

std::vector<Fault> jsonFaults() {
  std::string many = "\"x0\":1";
  for (int i = 1; i < 40000; ++i) many += ",\"x" + std::to_string(i) + "\":1";
  return {
      {"not JSON", weightFile("{what is this}", ""), "the header is not JSON"},
      {"cut JSON", weightFile("{\"a\":{\"dtype\"", ""), "the header is not JSON"},
      {"not UTF-8", weightFile("{\"\xFF\xFE\":1}", ""), "the header is not JSON"},
      {"number beyond double", weightFile("{\"a\":1e999}", ""), "the header is not JSON"},
      {"two values", weightFile("{}{}", ""), "the header is not JSON"},
      {"array", weightFile("[1]", ""), "does not begin with '{'"},
      {"byte order mark", weightFile("\xEF\xBB\xBF{}", ""), "does not begin with '{'"},
      {"deep nesting", weightFile("{\"a\":" + std::string(100000, '['), ""),
       "nested deeper than 8"},
      {"many values", weightFile("{" + many + "}", ""), "more than 65536 values"},
      {"long key", weightFile("{\"" + std::string(300, 'k') + "\":1}", ""), "a key of 300 bytes"},
      {"long string", weightFile("{\"\\\"\":\"" + std::string((1u << 20) + 1, 's') + "\"}", ""),
       "a string of 1048577 bytes"},
      {"long number", weightFile("{\"a\":" + std::string(1u << 20, '1') + "}", ""),
       "a stretch without strings of 1048578 bytes"},
      {"tensor twice",
       fileOf(entry("a", "F32", "[2]", "[0,8]") + "," + entry("a", "F32", "[2]", "[0,8]")),
       "duplicate key 'a'"},
      {"dtype twice",
       fileOf("\"a\":{\"dtype\":\"F32\",\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[0,8]}"),
       "duplicate key 'dtype'"}};
}

std::vector<Fault> entryFaults() {
  return {
      {"tensor that is a number", fileOf("\"a\":7"), "tensor 'a' is an integer"},
      {"foreign key",
       fileOf("\"a\":{\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[0,8],\"code\":1}"),
       "tensor 'a' has a foreign key 'code'"},
      {"no dtype", fileOf("\"a\":{\"shape\":[2],\"data_offsets\":[0,8]}"),
       "tensor 'a' lacks the key 'dtype'"},
      {"no shape", fileOf("\"a\":{\"dtype\":\"F32\",\"data_offsets\":[0,8]}"),
       "tensor 'a' lacks the key 'shape'"},
      {"no offsets", fileOf("\"a\":{\"dtype\":\"F32\",\"shape\":[2]}"),
       "tensor 'a' lacks the key 'data_offsets'"},
      {"unknown dtype", fileOf(entry("a", "Q7", "[2]", "[0,8]")), "dtype is \"Q7\"; F16 or F32"},
      {"BF16", fileOf(entry("a", "BF16", "[4]", "[0,8]")), "dtype is \"BF16\"; F16 or F32"},
      {"I64", fileOf(entry("a", "I64", "[1]", "[0,8]")), "dtype is \"I64\"; F16 or F32"},
      {"dtype that is a number",
       fileOf("\"a\":{\"dtype\":32,\"shape\":[2],\"data_offsets\":[0,8]}"), "dtype is 32"},
      {"shape that is a number", fileOf(entry("a", "F32", "2", "[0,8]")), "shape is an integer"},
      {"negative dimension", fileOf(entry("a", "F32", "[-2]", "[0,8]")),
       "an element of shape is -2"},
      {"fraction as dimension", fileOf(entry("a", "F32", "[2.0]", "[0,8]")),
       "an element of shape is a number with a fraction"},
      {"text as dimension", fileOf(entry("a", "F32", "[\"2\"]", "[0,8]")),
       "an element of shape is a string"},
      {"dimension of 2^63", fileOf(entry("a", "F32", "[9223372036854775808]", "[0,8]")),
       "an element of shape is 9223372036854775808"},
      {"shape that overflows", fileOf(entry("a", "F32", "[1099511627776,1099511627776]", "[0,8]")),
       "shape [1099511627776, 1099511627776] overflows"},
      {"shape that wraps around to 8 bytes",
       fileOf(entry("a", "F32", "[4611686018427387904,4,2]", "[0,8]")), "overflows 64 bits"}};
}

std::vector<Fault> offsetFaults() {
  return {{"one offset", fileOf(entry("a", "F32", "[2]", "[8]")), "data_offsets has 1 elements"},
          {"negative offset", fileOf(entry("a", "F32", "[2]", "[-8,0]")),
           "data_offsets' begin is -8; 0 to"},
          {"fraction as offset", fileOf(entry("a", "F32", "[2]", "[0,8.5]")),
           "data_offsets' end is a number with a fraction"},
          {"begin after end", fileOf(entry("a", "F32", "[2]", "[8,0]")),
           "data_offsets begin at 8 and end before, at 0"},
          {"offsets too long for the shape", fileOf(entry("a", "F32", "[1]", "[0,8]")),
           "data_offsets span 8 bytes; shape [1] and dtype need 4"},
          {"offsets of another dtype", fileOf(entry("a", "F16", "[2]", "[0,8]")),
           "data_offsets span 8 bytes; shape [2] and dtype need 4"},
          {"overlap",
           fileOf(entry("a", "F32", "[2]", "[0,8]") + "," + entry("b", "F32", "[1]", "[4,8]")),
           "tensor 'b' begins at byte 4, an overlap with"},
          {"two tensors on the same bytes",
           fileOf(entry("a", "F32", "[2]", "[0,8]") + "," + entry("b", "F32", "[2]", "[0,8]")),
           "tensor 'b' begins at byte 0, an overlap with"},
          {"gap before the first", fileOf(entry("a", "F32", "[1]", "[4,8]")),
           "tensor 'a' begins at byte 4, a gap after"},
          {"gap between two",
           fileOf(entry("a", "F16", "[2]", "[0,4]") + "," + entry("b", "F16", "[1]", "[6,8]")),
           "tensor 'b' begins at byte 6, a gap after"},
          {"truncated data", fileOf(entry("a", "F32", "[2]", "[0,8]"), data().substr(0, 7)),
           "truncated: the tensors need 8 bytes after the header, the file has 7"},
          {"tensor of 4 TiB", fileOf(entry("a", "F32", "[1099511627776]", "[0,4398046511104]")),
           "truncated: the tensors need 4398046511104 bytes"},
          {"trailing bytes", fileOf(entry("a", "F32", "[2]", "[0,8]"), data() + "x"),
           "1 trailing bytes after the last tensor"}};
}

std::vector<Fault> contentFaults() {
  const float nan = std::nanf("");
  const float infinity = std::numeric_limits<float>::infinity();
  const std::string sound = entry("a", "F32", "[2]", "[0,8]");
  const std::string half_infinity("\x00\x00\x00\x7C", 4);
  const std::string other = core::sha256("other");
  const auto with = [&](const std::string& metadata) {
    return weightFile("{\"__metadata__\":" + metadata + "," + sound + "}", data());
  };
  return {{"missing tensor", fileOf(entry("b", "F32", "[2]", "[0,8]")),
           "missing tensor 'a' of shape [2]"},
          {"foreign tensor",
           fileOf(sound + "," + entry("b", "F32", "[1]", "[8,12]"), data() + data().substr(0, 4)),
           "unknown tensor 'b'"},
          {"empty foreign tensor", fileOf(sound + "," + entry("b", "F32", "[0]", "[8,8]")),
           "unknown tensor 'b'"},
          {"wrong shape", fileOf(entry("a", "F32", "[1,2]", "[0,8]")),
           "tensor 'a' has shape [1, 2]; [2] was expected"},
          {"nan", fileOf(sound, floatBytes({1.0F, nan})), "tensor 'a' holds nan at element 1"},
          {"infinity", fileOf(sound, floatBytes({infinity, 1.0F})),
           "tensor 'a' holds inf at element 0"},
          {"infinite half", fileOf(entry("a", "F16", "[2]", "[0,4]"), half_infinity),
           "tensor 'a' holds inf at element 1"},
          {"wrong checksum", with("{\"sha256\":\"" + other + "\"}"), "the file is damaged"},
          {"short checksum", with("{\"sha256\":\"abc\"}"), "sha256 has 3 characters"},
          {"no checksum", with("{}"), "the metadata lacks the key 'sha256'"},
          {"no metadata", weightFile("{" + sound + "}", data()), "lacks the key 'sha256'"},
          {"metadata that is a list", with("[]"), "__metadata__ is an array"},
          {"metadata value that is a number", with("{\"sha256\":\"" + other + "\",\"steps\":5}"),
           "metadata 'steps' is an integer; a string was expected"},
          {"metadata key twice", with("{\"sha256\":\"" + other + "\",\"sha256\":\"\"}"),
           "duplicate key 'sha256'"}};
}

class SafetensorsFaults : public ::testing::Test {
 protected:
  std::string errorOf(const std::string& bytes) {
    test::writeBytes(file_, bytes);
    return test::inputErrorOf([&] { readPair(file_); });
  }
  void expectAll(const std::vector<Fault>& faults) {
    for (const Fault& fault : faults) {
      const std::string error = errorOf(fault.bytes);
      EXPECT_NE(error.find(fault.expected), std::string::npos) << fault.name << ": " << error;
      EXPECT_EQ(error.find("weight file '" + file_.string() + "'"), 0u)
          << fault.name << ": " << error;
      EXPECT_LT(error.size(), 1000u) << fault.name;
    }
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "file.safetensors";
};

TEST_F(SafetensorsFaults, TheSoundFileIsRead) {
  test::writeBytes(file_, soundFile());
  EXPECT_EQ(readPair(file_).tensors.at("a").values, (std::vector<float>{1.0F, 2.0F}));
}

TEST_F(SafetensorsFaults, Lengths) { expectAll(lengthFaults()); }
TEST_F(SafetensorsFaults, Json) { expectAll(jsonFaults()); }
TEST_F(SafetensorsFaults, Entries) { expectAll(entryFaults()); }
TEST_F(SafetensorsFaults, Offsets) { expectAll(offsetFaults()); }
TEST_F(SafetensorsFaults, Contents) { expectAll(contentFaults()); }

TEST_F(SafetensorsFaults, WhatIsNoFile) {
  const auto errorOfPath = [](const std::filesystem::path& path) {
    return test::inputErrorOf([&] { readPair(path); });
  };
  EXPECT_NE(errorOfPath(folder_.path()).find("is a folder"), std::string::npos);
  EXPECT_NE(errorOfPath(folder_.path() / "none").find("no such file"), std::string::npos);
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(errorOfPath(pipe).find("is not a regular file"), std::string::npos);
}

TEST_F(SafetensorsFaults, EveryTruncationIsRefused) {
  const std::string sound = soundFile();
  for (std::size_t size = 0; size < sound.size(); ++size) {
    EXPECT_NE(errorOf(sound.substr(0, size)), "no error") << size;
  }
}

/// Whatever a flipped bit does, the file is refused or read as it was: never other values.
TEST_F(SafetensorsFaults, EveryFlippedBitIsRefusedOrHarmless) {
  const std::string sound = soundFile();
  for (std::size_t bit = 0; bit < 8 * sound.size(); ++bit) {
    std::string flipped = sound;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    test::writeBytes(file_, flipped);
    try {
      const SafetensorsFile content = readPair(file_);
      EXPECT_EQ(content.tensors.at("a").values, (std::vector<float>{1.0F, 2.0F})) << bit;
    } catch (const core::InputError&) {
    }
  }
}

}  // namespace
}  // namespace cdiff::inference

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "diffusion/model.h"
#include "inference/weight_file_text.h"
#include "support/tensors.h"

namespace cdiff::diffusion {
namespace {

namespace fs = std::filesystem;
using Metadata = std::map<std::string, std::string>;

/// Small wherever the architecture allows it: T = 2, two levels of 8 channels.
Architecture smallArchitecture() {
  Architecture a;
  a.horizon = 2;
  a.channels = {8, 8};
  a.time_width = 4;
  a.image_width = 32;
  a.image_height = 32;
  a.image_features = 4;
  a.route_points = 2;
  a.route_features = 4;
  a.speed_features = 4;
  a.context_width = 8;
  a.state_hidden = 8;
  return a;
}

/// Values that F16 holds exactly: multiples of 1/8 up to 125.
std::map<std::string, inference::Tensor> filled(const std::vector<inference::TensorShape>& shapes) {
  std::map<std::string, inference::Tensor> tensors;
  int next = 0;
  for (const inference::TensorShape& shape : shapes) {
    tensors[shape.name] = test::tensorOf(
        shape.shape, [&](std::uint32_t) { return (next = (next + 7) % 1001) / 8.0; });
  }
  return tensors;
}

Model smallModel() {
  Model model;
  model.architecture = smallArchitecture();
  model.normalizer.mean = traffic::Rollout::Constant(2, 7, 1.0 / 3.0);
  model.normalizer.scale = traffic::Rollout::Constant(2, 7, 2.0);
  model.normalizer.scale(1, 6) = 0.1;
  model.spread = traffic::Rollout::Constant(2, 7, 0.7);
  model.spread(0, 1) = 1e-3;
  model.denoiser = filled(denoiserTensors(model.architecture));
  return model;
}

void expectEqual(const std::map<std::string, inference::Tensor>& left,
                 const std::map<std::string, inference::Tensor>& right) {
  ASSERT_EQ(left.size(), right.size());
  for (const auto& [name, tensor] : left) {
    ASSERT_EQ(right.count(name), 1u) << name;
    EXPECT_EQ(right.at(name).shape, tensor.shape) << name;
    EXPECT_TRUE(right.at(name).values == tensor.values) << name;
  }
}

/// "[[v,...],[v,...]]" of T = 2.
std::string matrix(const std::string& value) {
  std::string row = value;
  for (int i = 1; i < 7; ++i) row += "," + value;
  return "[[" + row + "],[" + row + "]]";
}

Metadata metadataOf(const std::string& part) {
  return {{"format", "e2e_cdiff." + part + ".1"},
          {"architecture", smallArchitecture().toJson()},
          {"normalizer", "{\"mean\":" + matrix("0.5") + ",\"scale\":" + matrix("2") + "}"},
          {"spread", matrix("1")}};
}

/// Sets an environment variable for one test.
class Setting {
 public:
  Setting(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;
  ~Setting() {
    if (before_) {
      ::setenv(name_, before_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

class ModelFiles : public ::testing::Test {
 protected:
  void writeDenoiser(const Metadata& metadata) {
    inference::writeSafetensors(folder_.path() / "denoiser.safetensors",
                                {metadata, filled(denoiserTensors(smallArchitecture()))},
                                inference::TensorType::kF32);
  }
  /// Without tensors: what the metadata says is checked before them.
  void writeEncoder(const Metadata& metadata) {
    inference::writeSafetensors(folder_.path() / "encoder.safetensors", {metadata, {}},
                                inference::TensorType::kF32);
  }
  std::string loadError() {
    return test::inputErrorOf([&] { loadModel(folder_.path().string()); });
  }
  /// Error of a denoiser whose metadata have another value; nullopt: lack the key.
  std::string errorWith(const std::string& key, const std::optional<std::string>& value) {
    Metadata metadata = metadataOf("denoiser");
    metadata.erase(key);
    if (value) metadata[key] = *value;
    writeDenoiser(metadata);
    return loadError();
  }
  /// Error of a sound denoiser beside an encoder whose metadata have another value.
  std::string encoderErrorWith(const std::string& key, const std::string& value) {
    Metadata metadata = metadataOf("encoder");
    metadata[key] = value;
    writeDenoiser(metadataOf("denoiser"));
    writeEncoder(metadata);
    return loadError();
  }
  static void expectMentions(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ModelFiles, RoundTrip) {
  Model model = smallModel();
  model.encoder = filled(encoderTensors(model.architecture));
  const fs::path folder = folder_.path() / "new" / "tiny";
  saveModel(model, folder, inference::TensorType::kF32, {{"training.steps", "100"}});
  const Model back = loadModel(folder.string() + "/");
  EXPECT_EQ(back.name, "tiny");
  EXPECT_EQ(back.sha256.size(), 64u);
  EXPECT_TRUE(back.architecture == model.architecture);
  EXPECT_EQ(back.normalizer.mean, model.normalizer.mean);
  EXPECT_EQ(back.normalizer.scale, model.normalizer.scale);
  EXPECT_EQ(back.spread, model.spread);
  expectEqual(back.encoder, model.encoder);
  expectEqual(back.denoiser, model.denoiser);
  expectMentions(test::readBytes(folder / "denoiser.safetensors").substr(0, 4000),
                 "\"training.steps\":\"100\"");
  // The encoder's file tells nothing of the denoiser, so a denoiser trained again leaves it alone.
  const std::string encoder = test::readBytes(folder / "encoder.safetensors");
  model.spread *= 2.0;
  saveModel(model, folder, inference::TensorType::kF32, {{"training.steps", "200"}});
  EXPECT_EQ(test::readBytes(folder / "encoder.safetensors"), encoder);
  // F16 holds these values exactly, in other bytes.
  saveModel(model, folder, inference::TensorType::kF16, {});
  const Model halves = loadModel(folder.string());
  expectEqual(halves.encoder, model.encoder);
  EXPECT_NE(halves.sha256, back.sha256);
}

TEST_F(ModelFiles, AnEncoderOfOtherWeightsIsRefused) {
  Model model = smallModel();
  model.encoder = filled(encoderTensors(model.architecture));
  const fs::path folder = folder_.path();
  saveModel(model, folder, inference::TensorType::kF32, {});
  const std::string denoiser = test::readBytes(folder / "denoiser.safetensors");
  model.encoder.begin()->second.values.front() += 1.0F;
  saveModel(model, folder, inference::TensorType::kF32, {});
  test::writeBytes(folder / "denoiser.safetensors", denoiser);
  expectMentions(loadError(), "does not belong to the denoiser beside it");
}

TEST_F(ModelFiles, MissingMetadataIsNamed) {
  for (const char* key : {"format", "architecture", "normalizer", "spread"}) {
    expectMentions(errorWith(key, std::nullopt),
                   "denoiser.safetensors': the metadata lacks the key '" + std::string(key) + "'");
  }
}

TEST_F(ModelFiles, MalformedMetadataIsNamed) {
  const auto normalizer = [](const std::string& mean, const std::string& scale) {
    return "{\"mean\":" + mean + ",\"scale\":" + scale + "}";
  };
  expectMentions(errorWith("format", "e2e_cdiff.encoder.1"), "'e2e_cdiff.denoiser.1' was expected");
  expectMentions(errorWith("architecture", "{}"), "the architecture lacks the key 'horizon'");
  expectMentions(errorWith("normalizer", "[]"), "'normalizer' is an array");
  expectMentions(errorWith("normalizer", "{"), "'normalizer' is not JSON");
  expectMentions(errorWith("normalizer", normalizer(matrix("0"), matrix("0"))),
                 "scale of row 0, column 0 is 0; a positive one");
  expectMentions(errorWith("normalizer", normalizer(matrix("0"), matrix("-1"))),
                 "is -1; a positive");
  expectMentions(errorWith("normalizer", normalizer(matrix("null"), matrix("1"))),
                 "mean, row 0, column 0 is null; a number");
  expectMentions(errorWith("normalizer", normalizer("[[1,2]]", matrix("1"))),
                 "mean is an array of 1; T = 2 rows");
  expectMentions(errorWith("normalizer", normalizer("[[1,2],[1,2]]", matrix("1"))),
                 "mean, row 0: 7 numbers");
  expectMentions(errorWith("spread", "[[1]]"), "'spread' is an array of 1; T = 2 rows");
  expectMentions(errorWith("spread", matrix("-0.5")), "spread: row 0, column 0 is -0.5");
  expectMentions(errorWith("spread", matrix("nan")), "'spread' is not JSON");
}

TEST_F(ModelFiles, AnotherHorizonDoesNotFitTheScales) {
  Architecture longer = smallArchitecture();
  longer.horizon = 4;
  expectMentions(errorWith("architecture", longer.toJson()), "is an array of 2; T = 4 rows");
}

TEST_F(ModelFiles, AnotherArchitectureDoesNotFitTheTensors) {
  Architecture wider = smallArchitecture();
  wider.state_hidden = 9;
  expectMentions(errorWith("architecture", wider.toJson()),
                 "tensor 'state.0.weight' has shape [8, 11]; [9, 11] was expected");
}

TEST_F(ModelFiles, FilesOfTwoModelsAreRefused) {
  Architecture other = smallArchitecture();
  other.diffusion_steps = 50;
  expectMentions(encoderErrorWith("architecture", other.toJson()),
                 "does not belong to the denoiser beside it: its architecture");
  Metadata metadata = metadataOf("denoiser");
  metadata["encoder"] = std::string(64, '0');
  writeDenoiser(metadata);
  writeEncoder(metadataOf("encoder"));
  expectMentions(loadError(), "trained with an encoder of SHA-256 0000");
  expectMentions(encoderErrorWith("note", "same model"), "missing tensor 'stem.conv.weight'");
}

TEST_F(ModelFiles, MissingFilesAreNamed) {
  expectMentions(loadError(), "denoiser.safetensors': no such file");
  writeDenoiser(metadataOf("denoiser"));
  expectMentions(loadError(), "encoder.safetensors': no such file");
}

TEST_F(ModelFiles, ShippedModelsAreFoundByName) {
  const fs::path share = folder_.path() / "share";
  fs::create_directories(share / "config");
  const Setting setting("E2E_CDIFF_SHARE", share.string());
  expectMentions(test::inputErrorOf([] { loadModel("e2e"); }), "which holds none");
  for (const char* name : {"e2e_cdiff", "image"}) {
    fs::create_directories(share / "weights" / name);
    test::writeBytes(share / "weights" / name / "denoiser.safetensors", "x");
  }
  const std::string error = test::inputErrorOf([] { loadModel("imago"); });
  expectMentions(error, "model 'imago' is neither a folder nor a shipped model in '" +
                            (fs::canonical(share) / "weights").string() + "'");
  expectMentions(error, "e2e_cdiff, image; the nearest is 'image'");
  expectMentions(test::inputErrorOf([] { loadModel(""); }), "model ''");
  // The file that a name leads to is the shipped one, here not a weight file.
  expectMentions(test::inputErrorOf([] { loadModel("image"); }),
                 "weights/image/denoiser.safetensors': truncated: 1 bytes");
}

TEST_F(ModelFiles, SaveRefusesWhatCouldNotBeLoaded) {
  const auto saveError = [&](const Model& model, const Metadata& facts) {
    return test::inputErrorOf(
        [&] { saveModel(model, folder_.path() / "out", inference::TensorType::kF32, facts); });
  };
  Model model = smallModel();
  expectMentions(saveError(model, {}), "encoder lacks tensor 'stem.conv.weight'");
  model.encoder = filled(encoderTensors(model.architecture));
  expectMentions(saveError(model, {{"spread", "1"}}), "training fact 'spread'");
  model.denoiser["more"] = {{1}, {1.0F}};
  // Conditioning 13, down 24 + 20, middle 20, up 24, head 6, state head 6; and the one too many.
  expectMentions(saveError(model, {}), "denoiser has 114 tensors; 113 were expected");
  model.denoiser.erase("more");
  model.denoiser["no_route"].shape = {2, 2};
  expectMentions(saveError(model, {}), "lacks tensor 'no_route'");
  model.normalizer.scale(0, 0) = 0.0;
  expectMentions(saveError(model, {}), "scale of row 0, column 0 is 0");
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

}  // namespace
}  // namespace cdiff::diffusion

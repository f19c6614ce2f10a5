// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/model.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <vector>

#include "core/file.h"
#include "core/kept_content.h"
#include "core/kept_hash.h"
#include "core/spelling.h"
#include "core/text.h"
#include "diffusion/normalizer.h"
#include "e2e_cdiff/core/exceptions.h"
#include "inference/strict_json.h"

namespace cdiff::diffusion {
namespace {

namespace fs = std::filesystem;

inference::SafetensorsFile readDenoiser(const fs::path& file, Model& model) {
  const std::string source = "weight file '" + file.string() + "'";
  return inference::readSafetensors(file, [&](const Metadata& metadata) {
    model.architecture = readArchitecture(metadata, kDenoiserFormat, source);
    readScales(metadata, source, model);
    return denoiserTensors(model.architecture);
  });
}

/// `denoiser` has been read already: what the two say is compared before any tensor is read.
inference::SafetensorsFile readEncoder(const fs::path& file, const Model& model,
                                       const Metadata& denoiser) {
  const std::string source = "weight file '" + file.string() + "'";
  const auto fail = [&](const std::string& what) {
    throw core::InputError(source + " does not belong to the denoiser beside it: " + what);
  };
  return inference::readSafetensors(file, [&](const Metadata& metadata) {
    const Architecture architecture = readArchitecture(metadata, kEncoderFormat, source);
    if (!(architecture == model.architecture)) {
      fail("its architecture is " + architecture.toJson() + ", that of the denoiser " +
           model.architecture.toJson());
    }
    const auto expected = denoiser.find(kEncoderKey);
    const auto found = metadata.find("sha256");
    if (expected != denoiser.end() && found != metadata.end() && expected->second != found->second)
      fail("that was trained with an encoder of SHA-256 " + inference::excerpt(expected->second) +
           ", this one has " + found->second);
    return encoderTensors(architecture);
  });
}

/// Names of the shipped models, sorted.
std::vector<std::string> shippedModels(const fs::path& weights) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(weights, error)) {
    if (fs::exists(entry.path() / kDenoiserFile, error)) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A plain name is a shipped model first; everything else is a folder.
fs::path folderOf(const std::string& name_or_folder) {
  const fs::path given(name_or_folder);
  const bool plain =
      !name_or_folder.empty() && given == given.filename() && given != "." && given != "..";
  const fs::path weights = core::shareFolder() / "weights";
  std::error_code error;
  if (plain && fs::is_directory(weights / given, error)) return weights / given;
  if (!name_or_folder.empty() && fs::is_directory(given, error)) {
    return fs::canonical(given);
  }
  const std::vector<std::string> names = shippedModels(weights);
  const std::string nearest = core::nearestName(name_or_folder, names);
  throw core::InputError(
      "model '" + name_or_folder + "' is neither a folder nor a shipped model in '" +
      weights.string() + "', which holds " +
      (names.empty() ? "none"
                     : core::joinText(names, ", ") + "; the nearest is '" + nearest + "'"));
}

void requireTensors(const std::map<std::string, inference::Tensor>& tensors,
                    const std::vector<inference::TensorShape>& expected, const std::string& what) {
  for (const inference::TensorShape& shape : expected) {
    const auto found = tensors.find(shape.name);
    if (found == tensors.end() || found->second.shape != shape.shape) {
      throw core::InputError("the model's " + what + " lacks tensor '" + shape.name +
                             "' or has it in another shape");
    }
  }
  if (tensors.size() != expected.size()) {
    throw core::InputError("the model's " + what + " has " + std::to_string(tensors.size()) +
                           " tensors; " + std::to_string(expected.size()) + " were expected");
  }
}

}  // namespace

Model loadModel(const std::string& name_or_folder) {
  const fs::path folder = folderOf(name_or_folder);
  Model model;
  inference::SafetensorsFile denoiser = readDenoiser(folder / kDenoiserFile, model);
  inference::SafetensorsFile encoder = readEncoder(folder / kEncoderFile, model, denoiser.metadata);
  model.name = folder.filename().string();
  model.sha256 = core::sha256(encoder.metadata.at("sha256") + denoiser.metadata.at("sha256"));
  model.encoder = std::move(encoder.tensors);
  model.denoiser = std::move(denoiser.tensors);
  return model;
}

std::string modelFilesSha256(const std::string& name_or_folder) {
  const fs::path folder = folderOf(name_or_folder);
  return core::sha256(core::keptSha256(folder / kEncoderFile, "weight file") +
                      core::keptSha256(folder / kDenoiserFile, "weight file"));
}

std::shared_ptr<const Model> sharedModel(const std::string& name_or_folder) {
  const auto load = [&] { return std::make_shared<Model>(loadModel(name_or_folder)); };
  if (!core::keepsContent()) return load();
  return core::keptContent<Model>(
      "model", folderOf(name_or_folder).string() + '\0' + modelFilesSha256(name_or_folder), load);
}

std::string identityOf(const Model& model) {
  std::string identity = model.sha256;
  for (const auto& [key, value] : describeDenoiser(model)) identity += "\n" + key + " " + value;
  return identity;
}

ModelFiles modelFiles(const Model& model) {
  validateDescription(model);
  requireTensors(model.encoder, encoderTensors(model.architecture), "encoder");
  requireTensors(model.denoiser, denoiserTensors(model.architecture), "denoiser");
  return {{describeEncoder(model), model.encoder}, {describeDenoiser(model), model.denoiser}};
}

void saveModel(const Model& model, const fs::path& folder, inference::TensorType type,
               const std::map<std::string, std::string>& training_facts) {
  ModelFiles files = modelFiles(model);
  for (const auto& fact : training_facts) {
    if (!isReservedKey(fact.first)) continue;
    throw core::InputError("training fact '" + fact.first + "' has the name of a reserved key");
  }
  Metadata& metadata = files.denoiser.metadata;
  metadata.insert(training_facts.begin(), training_facts.end());
  metadata[kEncoderKey] = inference::writeSafetensors(folder / kEncoderFile, files.encoder, type);
  inference::writeSafetensors(folder / kDenoiserFile, files.denoiser, type);
}

namespace {

constexpr const char* kReservedKeys[] = {"format", "architecture", "normalizer",
                                         "spread", kEncoderKey,    "sha256"};

const std::string& textOf(const Metadata& metadata, const std::string& key,
                          const std::string& source) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) {
    throw core::InputError(source + ": the metadata lacks the key '" + key + "'");
  }
  return found->second;
}

void requireSpread(const traffic::Rollout& spread, std::int64_t horizon) {
  if (spread.rows() != horizon) {
    throw core::InputError("spread: " + std::to_string(spread.rows()) +
                           " rows; T = " + std::to_string(horizon) + " was expected");
  }
  for (Eigen::Index i = 0; i < spread.size(); ++i) {
    const double value = spread.data()[i];
    if (std::isfinite(value) && value >= 0.0) continue;
    throw core::InputError("spread: row " + std::to_string(i / traffic::kRolloutColumns) +
                           ", column " + std::to_string(i % traffic::kRolloutColumns) + " is " +
                           core::formatNumber(value) + "; a value >= 0 was expected");
  }
}

}  // namespace

Metadata describeEncoder(const Model& model) {
  return {{"format", kEncoderFormat}, {"architecture", model.architecture.toJson()}};
}

Metadata describeDenoiser(const Model& model) {
  return {{"format", kDenoiserFormat},
          {"architecture", model.architecture.toJson()},
          {"normalizer", model.normalizer.toJson()},
          {"spread", rolloutText(model.spread)}};
}

Architecture readArchitecture(const Metadata& metadata, const std::string& format,
                              const std::string& source) {
  const std::string& actual = textOf(metadata, "format", source);
  if (actual != format) {
    throw core::InputError(source + ": the format is '" + inference::excerpt(actual) + "'; '" +
                           format + "' was expected");
  }
  return Architecture::fromJson(textOf(metadata, "architecture", source), source);
}

void readScales(const Metadata& metadata, const std::string& source, Model& model) {
  const std::int64_t rows = model.architecture.horizon;
  const std::string spread = source + ": metadata 'spread'";
  model.normalizer = Normalizer::fromJson(textOf(metadata, "normalizer", source), rows,
                                          source + ": metadata 'normalizer'");
  model.spread = rolloutOf(inference::parseStrictJson(textOf(metadata, "spread", source), spread),
                           rows, spread);
  try {
    validateDescription(model);
  } catch (const core::InputError& error) {
    throw core::InputError(source + ": " + error.what());
  }
}

void validateDescription(const Model& model) {
  model.architecture.validate();
  model.normalizer.validate(static_cast<int>(model.architecture.horizon));
  requireSpread(model.spread, model.architecture.horizon);
}

bool isReservedKey(const std::string& key) {
  return std::any_of(std::begin(kReservedKeys), std::end(kReservedKeys),
                     [&](const char* reserved) { return key == reserved; });
}

}  // namespace cdiff::diffusion

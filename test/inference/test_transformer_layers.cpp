// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "inference/transformer_layers.h"
#include "support/tensors.h"

namespace cdiff::inference {
namespace {

using test::uniformTensor;
using Matrix = std::vector<std::vector<double>>;
using Weights = std::map<std::string, Tensor>;

constexpr TransformerSizes kSizes = {32, 2, 48};

void addLinear(Weights& weights, const std::string& name, std::int64_t in, std::int64_t out) {
  weights[name + ".weight"] = uniformTensor(name + ".weight", {out, in}, 0.4);
  weights[name + ".bias"] = uniformTensor(name + ".bias", {out}, 0.4);
}

Weights layerWeights() {
  Weights weights;
  addLinear(weights, "l.query", kSizes.width, kSizes.width);
  addLinear(weights, "l.key_value", kSizes.width, 2 * kSizes.width);
  addLinear(weights, "l.output", kSizes.width, kSizes.width);
  addLinear(weights, "l.up", kSizes.width, kSizes.hidden);
  addLinear(weights, "l.down", kSizes.hidden, kSizes.width);
  for (const char* name : {"l.norm", "l.norm1", "l.norm2"}) {
    weights[std::string(name) + ".weight"] = uniformTensor(name, {kSizes.width}, 1.5);
    weights[std::string(name) + ".bias"] = uniformTensor(name, {kSizes.width}, 0.5);
  }
  return weights;
}

Matrix randomRows(std::size_t rows, std::size_t columns, const std::string& name) {
  const Tensor values = uniformTensor(
      name, {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns)}, 2.0);
  Matrix matrix(rows, std::vector<double>(columns));
  for (std::size_t i = 0; i < rows * columns; ++i)
    matrix[i / columns][i % columns] = static_cast<double>(values.values[i]);
  return matrix;
}

Rows rowsOf(const Matrix& matrix) {
  Rows rows;
  rows.resize(static_cast<std::int64_t>(matrix.size()),
              static_cast<std::int64_t>(matrix.front().size()));
  for (std::size_t r = 0; r < matrix.size(); ++r) {
    for (std::size_t c = 0; c < matrix[r].size(); ++c)
      rows.row(static_cast<std::int64_t>(r))[c] = static_cast<float>(matrix[r][c]);
  }
  return rows;
}

// The definitions in double precision.

Matrix linear(const Weights& weights, const std::string& name, const Matrix& x) {
  const Tensor& weight = weights.at(name + ".weight");
  const Tensor& bias = weights.at(name + ".bias");
  const auto outputs = static_cast<std::size_t>(weight.shape[0]);
  const auto inputs = static_cast<std::size_t>(weight.shape[1]);
  Matrix y(x.size(), std::vector<double>(outputs));
  for (std::size_t r = 0; r < x.size(); ++r) {
    for (std::size_t o = 0; o < outputs; ++o) {
      y[r][o] = static_cast<double>(bias.values[o]);
      for (std::size_t i = 0; i < inputs; ++i)
        y[r][o] += static_cast<double>(weight.values[o * inputs + i]) * x[r][i];
    }
  }
  return y;
}

Matrix normalized(const Weights& weights, const std::string& name, const Matrix& a,
                  const Matrix& b) {
  Matrix y = a;
  for (std::size_t r = 0; r < a.size(); ++r) {
    const auto count = static_cast<double>(a[r].size());
    double mean = 0.0, variance = 0.0;
    for (std::size_t c = 0; c < a[r].size(); ++c) mean += (y[r][c] = a[r][c] + b[r][c]) / count;
    for (const double value : y[r]) variance += (value - mean) * (value - mean) / count;
    for (std::size_t c = 0; c < a[r].size(); ++c) {
      y[r][c] = (y[r][c] - mean) / std::sqrt(variance + 1e-5) *
                    static_cast<double>(weights.at(name + ".weight").values[c]) +
                static_cast<double>(weights.at(name + ".bias").values[c]);
    }
  }
  return y;
}

/// Rows mixed by attention, and the weights [head][query][key].
Matrix attended(const Matrix& q, const Matrix& kv, std::vector<Matrix>& weights) {
  const auto width = static_cast<std::size_t>(kSizes.width);
  const std::size_t head_width = width / static_cast<std::size_t>(kSizes.heads);
  Matrix mixed(q.size(), std::vector<double>(width, 0.0));
  weights.assign(static_cast<std::size_t>(kSizes.heads), Matrix(q.size()));
  for (std::size_t h = 0; h < weights.size(); ++h) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      for (const std::vector<double>& key : kv) {
        weights[h][i].push_back(0.0);
        for (std::size_t d = h * head_width; d < (h + 1) * head_width; ++d)
          weights[h][i].back() += q[i][d] * key[d] / std::sqrt(static_cast<double>(head_width));
      }
      const double largest = *std::max_element(weights[h][i].begin(), weights[h][i].end());
      double sum = 0.0;
      for (double& weight : weights[h][i]) sum += (weight = std::exp(weight - largest));
      for (std::size_t j = 0; j < kv.size(); ++j) {
        weights[h][i][j] /= sum;
        for (std::size_t d = h * head_width; d < (h + 1) * head_width; ++d)
          mixed[i][d] += weights[h][i][j] * kv[j][width + d];
      }
    }
  }
  return mixed;
}

Matrix attentionOf(const Weights& weights, const Matrix& x, const Matrix& context,
                   std::vector<Matrix>& attention) {
  return linear(
      weights, "l.output",
      attended(linear(weights, "l.query", x), linear(weights, "l.key_value", context), attention));
}

Matrix mixOf(const Weights& weights, const Matrix& x) {
  Matrix hidden = linear(weights, "l.up", x);
  for (std::vector<double>& row : hidden) {
    for (double& value : row) value *= 0.5 * (1.0 + std::erf(value / std::sqrt(2.0)));
  }
  return linear(weights, "l.down", hidden);
}

Matrix transformed(const Weights& weights, const Matrix& x, std::vector<Matrix>& attention) {
  const Matrix middle = normalized(weights, "l.norm1", x, attentionOf(weights, x, x, attention));
  return normalized(weights, "l.norm2", middle, mixOf(weights, middle));
}

Matrix sum(Matrix a, const Matrix& b) {
  for (std::size_t r = 0; r < a.size(); ++r) {
    for (std::size_t c = 0; c < a[r].size(); ++c) a[r][c] += b[r % b.size()][c];
  }
  return a;
}

void expectNear(const Rows& found, std::int64_t first, const Matrix& expected, double tolerance) {
  for (std::size_t r = 0; r < expected.size(); ++r) {
    for (std::size_t c = 0; c < expected[r].size(); ++c) {
      EXPECT_NEAR(static_cast<double>(found.row(first + static_cast<std::int64_t>(r))[c]),
                  expected[r][c], tolerance)
          << "row " << r << " column " << c;
    }
  }
}

class TransformerLayers : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > bestInstructionSet()) GTEST_SKIP() << "this CPU lacks " << toText(GetParam());
  }
  TransformerLayer layer() const { return {{GetParam(), weights_}, "l", kSizes}; }

  Weights weights_ = layerWeights();
  TransformerMemory memory_;
  std::vector<Matrix> unused_;
};

TEST_P(TransformerLayers, ALayerIsWhatItsDefinitionSays) {
  // Two sequences of 5 and 19 rows: fewer and more keys than a vector has lanes.
  const Matrix first = randomRows(5, 32, "first"), second = randomRows(19, 32, "second");
  Matrix both = first;
  both.insert(both.end(), second.begin(), second.end());
  const Rows x = rowsOf(both);
  layer().forward({0, 5, 24}, x, memory_);
  expectNear(x, 0, transformed(weights_, first, unused_), 2e-5);
  expectNear(x, 5, transformed(weights_, second, unused_), 2e-5);
}

TEST_P(TransformerLayers, TheFirstRowAloneIsThatOfTheWholeLayerWithItsAttention) {
  const Matrix one = randomRows(1, 32, "one"), many = randomRows(18, 32, "many");
  Matrix both = one;
  both.insert(both.end(), many.begin(), many.end());
  std::vector<float> attention;
  layer().forwardFirst({0, 1, 19}, rowsOf(both), memory_, attention);
  std::vector<Matrix> expected_attention;
  const Matrix expected = transformed(weights_, many, expected_attention);
  expectNear(memory_.first, 1, {expected.front()}, 2e-5);
  ASSERT_EQ(attention.size(), 19U);
  EXPECT_FLOAT_EQ(attention[0], 1.0F) << "a row alone attends to itself";
  double total = 0.0;
  for (std::size_t j = 0; j < 18; ++j) {
    const double mean = 0.5 * (expected_attention[0][0][j] + expected_attention[1][0][j]);
    EXPECT_NEAR(static_cast<double>(attention[1 + j]), mean, 1e-6);
    total += static_cast<double>(attention[1 + j]);
  }
  EXPECT_NEAR(total, 1.0, 1e-5);
}

TEST_P(TransformerLayers, ASequenceIsTheSameToTheBitWhateverItsNeighbors) {
  const Matrix sequence = randomRows(7, 32, "sequence");
  const Rows alone = rowsOf(sequence);
  layer().forward({0, 7}, alone, memory_);
  for (const std::size_t before : {1, 3, 10}) {
    Matrix rows = randomRows(before, 32, "neighbors");
    rows.insert(rows.end(), sequence.begin(), sequence.end());
    const Rows x = rowsOf(rows);
    const auto begin = static_cast<std::int64_t>(before);
    layer().forward({0, begin, begin + 7}, x, memory_);
    for (std::int64_t r = 0; r < 7; ++r) {
      for (std::int64_t c = 0; c < kSizes.width; ++c)
        EXPECT_EQ(x.row(begin + r)[c], alone.row(r)[c]) << before << " rows before";
    }
  }
}

TEST_P(TransformerLayers, LargeScoresDoNotOverflow) {
  for (float& value : weights_.at("l.query.weight").values) value *= 300.0F;
  const Matrix sequence = randomRows(9, 32, "sequence");
  const Rows x = rowsOf(sequence);
  layer().forward({0, 9}, x, memory_);
  expectNear(x, 0, transformed(weights_, sequence, unused_), 2e-3);
}

// Rows 0, 2, 4 and 1, 3, 5 attend to each other, with two positions that repeat; then all attend to
// other rows, and the feed-forward network is added.
TEST_P(TransformerLayers, LayersThatNormalizeFirstAreWhatTheirDefinitionsSay) {
  const PreNormAttention attention({GetParam(), weights_}, "l", kSizes);
  const PreNormFeedForward mix({GetParam(), weights_}, "l");
  const Matrix zero(6, std::vector<double>(32, 0.0));
  const Matrix start = randomRows(6, 32, "start"), context = randomRows(3, 32, "context");
  const Matrix position = randomRows(2, 32, "position");
  const auto normed = [&](const Matrix& x) { return normalized(weights_, "l.norm", x, zero); };
  Matrix expected = start;
  const Matrix query = sum(normed(start), position);
  for (const std::size_t first : {0, 1}) {
    const Matrix rows = {query[first], query[first + 2], query[first + 4]};
    const Matrix change = attentionOf(weights_, rows, rows, unused_);
    for (std::size_t i = 0; i < 3; ++i)
      expected[first + 2 * i] = sum({start[first + 2 * i]}, {change[i]}).front();
  }
  expected = sum(expected, attentionOf(weights_, normed(expected), context, unused_));
  expected = sum(expected, mixOf(weights_, normed(expected)));
  const Rows x = rowsOf(start);
  attention.attendSelf({{0, 2, 3}, {1, 2, 3}}, x, rowsOf(position), memory_);
  attention.attendTo(rowsOf(context), x, memory_);
  mix.apply(x, memory_);
  expectNear(x, 0, expected, 5e-5);
}

// States of 5 units, padded to 16: r, z and n follow each other in the tensors' rows.
TEST_P(TransformerLayers, AGruStepIsWhatItsDefinitionSays) {
  Weights weights;
  addLinear(weights, "g.input", 4, 15);
  addLinear(weights, "g.state", 5, 15);
  GruCell gru({GetParam(), weights}, "g");
  ASSERT_EQ(gru.states(), 5);
  const Matrix input = randomRows(3, 4, "input");
  Matrix state = randomRows(3, 5, "state");
  const Rows states = rowsOf(state);
  const auto logistic = [](double x) { return 1.0 / (1.0 + std::exp(-x)); };
  for (int step = 0; step < 2; ++step) {
    gru.step(rowsOf(input), states);
    const Matrix x = linear(weights, "g.input", input), h = linear(weights, "g.state", state);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t i = 0; i < 5; ++i) {
        const double reset = logistic(x[r][i] + h[r][i]);
        const double update = logistic(x[r][5 + i] + h[r][5 + i]);
        const double proposed = std::tanh(x[r][10 + i] + reset * h[r][10 + i]);
        state[r][i] = (1.0 - update) * proposed + update * state[r][i];
      }
    }
    expectNear(states, 0, state, 1e-6);
  }
}

TEST_P(TransformerLayers, GeluIsAccurateFarOutToo) {
  AlignedFloats values(64);
  for (int i = 0; i < 64; ++i) values.data()[i] = 0.4F * static_cast<float>(i - 32);
  transformerKernels(GetParam()).gelu(values.data(), 64);
  for (int i = 0; i < 64; ++i) {
    const double x = static_cast<double>(0.4F * static_cast<float>(i - 32));
    EXPECT_NEAR(static_cast<double>(values.data()[i]),
                0.5 * x * (1.0 + std::erf(x / std::sqrt(2.0))), 2e-6)
        << x;
  }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, TransformerLayers,
                         testing::Values(InstructionSet::kPlain, InstructionSet::kAvx2,
                                         InstructionSet::kAvx512),
                         [](const auto& info) { return toText(info.param); });

}  // namespace
}  // namespace cdiff::inference

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/expression.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::storyboard {
namespace {

using core::InputError;

bool isNameLetter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

const std::string& valueOf(const std::string& name, const Parameters& parameters) {
  const auto found = parameters.find(name);
  if (found != parameters.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& entry : parameters) known.push_back("$" + entry.first);
  throw InputError("the parameter '$" + name + "' is not declared; expected one of {" +
                   core::joinText(known, ", ") + "}");
}

/// Reads an expression from left to right: one function for each level of precedence.
class ExpressionReader {
 public:
  ExpressionReader(const std::string& text, const Parameters& parameters)
      : text_(text), parameters_(parameters) {}

  double read() {
    const double value = disjunction();
    skipBlanks();
    if (place_ != text_.size()) fail("the end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw InputError("the expression '" + core::shortened(text_) + "' cannot be read at letter " +
                     std::to_string(place_ + 1) + "; expected " + expected);
  }
  void skipBlanks() {
    while (place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_])) != 0)
      ++place_;
  }
  bool take(char letter) {
    skipBlanks();
    if (place_ >= text_.size() || text_[place_] != letter) return false;
    ++place_;
    return true;
  }
  std::string name() {
    const std::size_t begin = place_;
    while (place_ < text_.size() && isNameLetter(text_[place_])) ++place_;
    return text_.substr(begin, place_ - begin);
  }
  bool takeWord(const std::string& word) {
    skipBlanks();
    const std::size_t before = place_;
    if (name() == word) return true;
    place_ = before;
    return false;
  }

  double disjunction() {
    double value = conjunction();
    while (takeWord("or")) value = (conjunction() != 0.0 || value != 0.0) ? 1.0 : 0.0;
    return value;
  }
  double conjunction() {
    double value = sum();
    while (takeWord("and")) value = (sum() != 0.0 && value != 0.0) ? 1.0 : 0.0;
    return value;
  }
  double sum() {
    double value = product();
    while (true) {
      if (take('+')) {
        value += product();
      } else if (take('-')) {
        value -= product();
      } else {
        return value;
      }
    }
  }
  double product() {
    double value = factor();
    while (true) {
      if (take('*')) {
        value *= factor();
      } else if (take('/')) {
        value /= divisor();
      } else if (take('%')) {
        value = std::fmod(value, divisor());
      } else {
        return value;
      }
    }
  }
  double divisor() {
    const double value = factor();
    if (value == 0.0)
      throw InputError("the expression '" + core::shortened(text_) + "' divides by zero");
    return value;
  }
  double factor() {
    constexpr int kDeepest = 100;
    if (++depth_ > kDeepest) fail("fewer nested brackets");
    double value = 0.0;
    if (take('-')) {
      value = -factor();
    } else if (take('(')) {
      value = disjunction();
      if (!take(')')) fail("')'");
    } else if (take('$')) {
      value = parameter();
    } else {
      value = numberOrCall();
    }
    --depth_;
    return value;
  }
  double parameter() {
    const std::string& text = valueOf(name(), parameters_);
    if (text == "true") return 1.0;
    if (text == "false") return 0.0;
    const auto value = core::parseNumber(text);
    if (!value) fail("a number instead of the parameter's '" + core::shortened(text) + "'");
    return *value;
  }
  double numberOrCall() {
    skipBlanks();
    const std::size_t begin = place_;
    if (begin < text_.size() && std::isalpha(static_cast<unsigned char>(text_[begin])) != 0)
      return call(name());
    while (place_ < text_.size() && isPartOfNumber(begin)) ++place_;
    const auto value = core::parseNumber(text_.substr(begin, place_ - begin));
    if (!value) fail("a number");
    return *value;
  }
  /// A sign belongs to a number only after its exponent's letter.
  bool isPartOfNumber(std::size_t begin) const {
    const char letter = text_[place_];
    if (std::isdigit(static_cast<unsigned char>(letter)) != 0 || letter == '.') return true;
    if (letter == 'e' || letter == 'E') return true;
    const bool sign = letter == '+' || letter == '-';
    return sign && place_ > begin && (text_[place_ - 1] == 'e' || text_[place_ - 1] == 'E');
  }
  double call(const std::string& function) {
    if (function == "true" || function == "false") return function == "true" ? 1.0 : 0.0;
    if (!take('(')) fail("'(' after '" + function + "'");
    std::vector<double> values = {disjunction()};
    while (take(',')) values.push_back(disjunction());
    if (!take(')')) fail("')'");
    const double value = values.size() == 1 ? ofOne(function, values[0])
                                            : ofTwo(function, values[0], values[1], values.size());
    if (!std::isfinite(value)) fail("a finite value of '" + function + "'");
    return value;
  }
  double ofOne(const std::string& function, double value) const {
    if (function == "round") return std::round(value);
    if (function == "floor") return std::floor(value);
    if (function == "ceil") return std::ceil(value);
    if (function == "sqrt") return std::sqrt(value);
    if (function == "abs") return std::abs(value);
    if (function == "sign") return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
    if (function == "not") return value == 0.0 ? 1.0 : 0.0;
    fail("a function of one number");
  }
  double ofTwo(const std::string& function, double first, double second, std::size_t count) const {
    if (function == "pow" && count == 2) return std::pow(first, second);
    if (function == "max" && count == 2) return std::max(first, second);
    if (function == "min" && count == 2) return std::min(first, second);
    fail("a function of two numbers");
  }

  std::string text_;
  const Parameters& parameters_;
  std::size_t place_ = 0;
  int depth_ = 0;
};

}  // namespace

std::string resolved(const std::string& text, const Parameters& parameters) {
  if (text.empty() || text[0] != '$') return text;
  if (text.size() > 2 && text[1] == '{' && text.back() == '}') {
    const std::string inside = text.substr(2, text.size() - 3);
    return core::formatNumber(ExpressionReader(inside, parameters).read());
  }
  return valueOf(text.substr(1), parameters);
}

}  // namespace cdiff::storyboard

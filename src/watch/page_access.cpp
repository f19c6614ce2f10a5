// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "watch/page_access.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <array>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::watch {
namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::size_t kTokenLetters = 2 * kTokenBytes;
constexpr const char* kNames[] = {"", "report.html", PageAccess::kSocket};

std::string randomToken() {
  std::array<unsigned char, kTokenBytes> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw core::Error("the system gives no random numbers for the address of the live page");
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4U];
    token += "0123456789abcdef"[byte & 15U];
  }
  return token;
}

}  // namespace

PageAccess::PageAccess(std::uint16_t port) : port_(port), token_(randomToken()) {}

std::string PageAccess::host() const { return "127.0.0.1:" + std::to_string(port_); }

bool PageAccess::isOurs(std::string_view host) const {
  return host == this->host() || host == "localhost:" + std::to_string(port_);
}

/// In constant time, so that a token cannot be guessed letter by letter.
bool PageAccess::knowsToken(std::string_view target) const {
  if (target.size() < kTokenLetters + 2 || target[0] != '/' || target[kTokenLetters + 1] != '/')
    return false;
  return CRYPTO_memcmp(target.data() + 1, token_.data(), kTokenLetters) == 0;
}

std::string_view PageAccess::name(std::string_view target) {
  return target.substr(kTokenLetters + 2);
}

int PageAccess::refusal(const PageRequest& request) const {
  if (!isOurs(request.host) || !knowsToken(request.target)) return 403;
  constexpr std::string_view kScheme = "http://";
  const bool foreign = request.origin.substr(0, kScheme.size()) != kScheme ||
                       request.origin.substr(kScheme.size()) != request.host;
  if (foreign && (request.upgrade || !request.origin.empty())) return 403;
  bool known = false;
  for (const char* one : kNames) known = known || name(request.target) == one;
  if (!known || request.upgrade != (name(request.target) == kSocket)) return 404;
  return request.method == "GET" ? 0 : 405;
}

}  // namespace cdiff::watch

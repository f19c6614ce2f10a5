// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cdiff::watch {

/// What of a request decides whether it is answered.
struct PageRequest {
  std::string_view method;  ///< "GET"
  std::string_view target;  ///< path, as the client wrote it
  std::string_view host;    ///< header Host; empty: none, or several
  std::string_view origin;  ///< header Origin; empty: none
  bool upgrade = false;     ///< whether it asks for a WebSocket
};

/// Who may see a session and steer it: whoever knows its address, which holds a random token, from
/// a page of this very server. The check of Host keeps out names that were pointed at this computer
/// (DNS rebinding), that of Origin pages of other servers.
class PageAccess {
 public:
  static constexpr const char* kSocket = "socket";  ///< name of the WebSocket below the token

  /// With 128 random bits as token. Throws core::Error where the system has none.
  explicit PageAccess(std::uint16_t port);

  /// "127.0.0.1:8080".
  std::string host() const;
  /// "http://127.0.0.1:8080/TOKEN/": for the user's terminal and nothing else.
  std::string address() const { return "http://" + host() + "/" + token_ + "/"; }
  /// The HTTP status that refuses the request (403, 404, 405); 0: it may be answered.
  int refusal(const PageRequest& request) const;
  /// What the path names below the token; empty: the page. Of a request that is not refused.
  static std::string_view name(std::string_view target);

 private:
  bool knowsToken(std::string_view target) const;
  bool isOurs(std::string_view host) const;

  std::uint16_t port_;
  std::string token_;
};

}  // namespace cdiff::watch

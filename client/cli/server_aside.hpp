#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/cli/own_server.hpp"

namespace collided::cli {

/// A server of this program in a namespace of its own, so that it affects no other world. One thread.
class ServerAside {
 public:
  /// Starts it and waits until it answers. Throws Failure if that is impossible.
  ///
  /// purpose  a word that begins its namespace
  /// words    further arguments of the program collided
  ServerAside(Session& outer, const Globals& globals, std::string_view purpose, const std::vector<std::string>& words);

  /// The session to it, and the options that connect to it.
  Session& session() { return session_; }
  const Globals& globals() const { return globals_; }

 private:
  Globals globals_;
  OwnServer server_;
  Session session_;
};

}  // namespace collided::cli

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/cli/own_server.hpp"

namespace collided::cli {

/// A server of this program's own in a namespace of its own, so that it touches nobody else's world. One thread.
class ServerAside {
 public:
  /// Starts it and waits until it answers. Throws Failure where that cannot be.
  ///
  /// purpose  a word that begins its namespace
  /// words    further arguments of the program collided
  ServerAside(Session& outer, const Globals& globals, std::string_view purpose, const std::vector<std::string>& words);

  /// The session to it, and the options that lead there.
  Session& session() { return session_; }
  const Globals& globals() const { return globals_; }

 private:
  Globals globals_;
  OwnServer server_;
  Session session_;
};

}  // namespace collided::cli

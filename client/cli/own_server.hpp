#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/session.hpp"

namespace collided::cli {

/// A server that this program starts, and that ends with it. It has its own state folder, so that it takes over no
/// other server's world and leaves nothing behind. One thread.
class OwnServer {
 public:
  /// Starts the program collided at this domain and namespace. Throws Failure if that is impossible.
  ///
  /// words  its further arguments
  OwnServer(Io& io, const ConnectOptions& where, const std::vector<std::string>& words);
  ~OwnServer();
  OwnServer(const OwnServer&) = delete;
  OwnServer& operator=(const OwnServer&) = delete;

  /// Waits until it answers. Throws Failure if it ends before, or on Ctrl-C.
  ///
  /// session  whose connection, made by globals, is to the domain and namespace given above
  void meet(Session& session, const Globals& globals);
  bool ended();
  /// The exit code of a server that has ended.
  int exit_code() const;

 private:
  /// A folder that is removed with its owner.
  struct Folder {
    std::string path;
    ~Folder();
  };

  Folder folder_;
  pid_t id_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace collided::cli

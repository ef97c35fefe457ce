#include "client/cli/server_aside.hpp"

#include <unistd.h>

#include <fmt/format.h>

namespace collided::cli {
namespace {

Globals globals_aside(const Io& io, const Globals& globals, std::string_view purpose) {
  Globals its_own = globals;
  its_own.domain = std::to_string(connect_options(io, globals).domain);
  its_own.name_space = fmt::format("{}_{}", purpose, ::getpid());
  return its_own;
}

}  // namespace

ServerAside::ServerAside(Session& outer, const Globals& globals, std::string_view purpose,
                         const std::vector<std::string>& words)
    : globals_(globals_aside(outer.io, globals, purpose)),
      server_(outer.io, connect_options(outer.io, globals_), words),
      session_(outer.io, outer.own) {
  server_.meet(session_, globals_);
}

}  // namespace collided::cli

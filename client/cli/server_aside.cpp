#include "client/cli/server_aside.hpp"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace collided::cli {
namespace {

Globals globals_aside(const Io& io, const Globals& globals, std::string_view purpose) {
  Globals its_own = globals;
  its_own.domain = std::to_string(connect_options(io, globals).domain);
  its_own.name_space = fmt::format("{}_{}", purpose, ::getpid());
  return its_own;
}

std::vector<std::string> with_folder(const std::string& folder, const std::vector<std::string>& words) {
  std::vector<std::string> all{"--state-dir", folder};
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

}  // namespace

ServerAside::Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

ServerAside::ServerAside(Session& outer, const Globals& globals, std::string_view purpose,
                         const std::vector<std::string>& words)
    : globals_(globals_aside(outer.io, globals, purpose)),
      folder_{(std::filesystem::temp_directory_path() / fmt::format("collide-{}-{}", purpose, ::getpid())).string()},
      server_(outer.io, connect_options(outer.io, globals_), with_folder(folder_.path, words)),
      session_(outer.io) {
  server_.meet(session_, globals_);
}

}  // namespace collided::cli

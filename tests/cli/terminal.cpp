#include "tests/cli/terminal.hpp"

#include <unistd.h>

#include <cstdio>

#include "client/cli/input/tokens.hpp"
#include "client/cli/run.hpp"

const collided::cli::OwnParts& every_wing() {
  using namespace collided::cli;
  static const OwnParts parts{
      .verbs = {
          {"draw", make_draw}, {"fleet", make_fleet}, {"keys", make_keys}, {"ros", make_ros}, {"view", make_view}}};
  return parts;
}

Ran collide(const std::string& words, const Terminal& terminal) {
  std::FILE* file = std::tmpfile();
  std::fwrite(terminal.in.data(), 1, terminal.in.size(), file);
  std::rewind(file);
  std::ostringstream out;
  std::ostringstream err;
  collided::cli::stop_requested = false;
  collided::cli::Io io{.in = fileno(file),
                       .out = out,
                       .err = err,
                       .out_is_terminal = terminal.out_is_terminal,
                       .err_is_terminal = terminal.err_is_terminal,
                       .environment = [&](const char* name) -> const char* {
                         const auto found = terminal.environment.find(name);
                         return found == terminal.environment.end() ? nullptr : found->second.c_str();
                       }};
  Ran ran;
  ran.code = collided::cli::run(collided::cli::split_words(words), io, every_wing());
  std::fclose(file);
  ran.out = out.str();
  ran.err = err.str();
  return ran;
}

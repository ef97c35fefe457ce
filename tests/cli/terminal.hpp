#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "client/cli/command.hpp"

/// All verbs in this process, those that `collide` leaves to programs of their own as well.
const collided::cli::OwnParts& every_wing();

/// One run of the program: what it printed and how it ended.
struct Ran {
  int code = 0;
  std::string out;
  std::string err;
};

struct Terminal {
  bool out_is_terminal = false;
  bool err_is_terminal = false;
  std::string in = {};
  std::map<std::string, std::string> environment = {};
};

/// Runs `collide WORDS`, the words split as a shell would.
Ran collide(const std::string& words, const Terminal& terminal = {});

/// As a person at a wide terminal sees it; 0: of a width that only the terminal itself knows.
inline Ran at_terminal(const std::string& words, int columns = 160) {
  Terminal terminal{.out_is_terminal = true, .err_is_terminal = false, .in = {}, .environment = {{"NO_COLOR", "1"}}};
  if (columns > 0) terminal.environment["COLUMNS"] = std::to_string(columns);
  return collide(words, terminal);
}

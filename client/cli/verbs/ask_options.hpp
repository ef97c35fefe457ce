#pragma once

#include <string>

#include <collided/client.hpp>

#include "client/cli/session.hpp"

namespace CLI {
class App;
}

namespace collided::cli {

/// Options of every question, as the user wrote them.
struct AskTexts {
  std::string only;
  std::string skip;
  std::string mask;
  std::string max_hits;
  std::string within;
  std::string deadline;
  std::string importance;
  std::string as_of;
  bool fresh = false;
};

/// latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds since 1970; throws Failure.
Instant parse_instant(const std::string& text);

void declare_ask_options(CLI::App& app, AskTexts& texts);
AskOptions ask_options_of(const AskTexts& texts, const Globals& globals);

}  // namespace collided::cli

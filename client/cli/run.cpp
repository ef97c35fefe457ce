#include "client/cli/run.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/global_options.hpp"
#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/tokens.hpp"
#include "client/cli/output/help.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/sibling_program.hpp"

namespace collided::cli {
namespace {

/// The index of the verb in the tokens, after options that every verb has; tokens.size() if there is none.
std::size_t verb_position(const std::vector<std::string>& tokens) {
  CLI::App globals_only("", "collide");
  Globals ignored;
  declare_globals(globals_only, ignored);
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    if (tokens[at] == "-" || !tokens[at].starts_with("-")) return at;
    const CLI::Option* option = globals_only.get_option_no_throw(tokens[at]);
    const bool takes_value = option != nullptr && option->get_items_expected_max() > 0;
    if (takes_value) ++at;
  }
  return tokens.size();
}

/// Throws Failure for arguments that the parser did not use.
void refuse_leftovers(CLI::App& app) {
  for (const std::string& leftover : app.remaining()) {
    const std::string word = unmarked(leftover);
    if (word == leftover && word.starts_with("-")) {
      throw bad_use(fmt::format("unknown option '{}'{}", word, did_you_mean(word, option_names(app))));
    }
    constexpr std::string_view kFirstWord = "collide ";
    const std::string& name = app.get_name();
    const std::string help = name.starts_with(kFirstWord) ? "collide help " + name.substr(kFirstWord.size()) : "";
    throw bad_use(fmt::format("'{}' has no meaning here", word), help);
  }
}

/// The parser's error in this program's words.
std::string in_words(const CLI::ParseError& error) {
  const std::string said = error.what();
  if (const std::size_t end = said.find(" is required"); end != std::string::npos)
    return fmt::format("which {}?", said.substr(0, end));
  const std::size_t colon = said.find(": ");
  if (colon != std::string::npos && said.ends_with(" missing")) return said.substr(0, colon) + " takes a value";
  return said;
}

/// Parses the tokens into the declared members. Throws CLI::CallForHelp, and Failure for anything wrong.
void parse_tokens(CLI::App& app, std::vector<std::string> tokens) {
  app.allow_extras();
  for (CLI::Option* option : app.get_options())
    option->transform([](std::string text) { return unmarked(std::move(text)); });
  std::reverse(tokens.begin(), tokens.end());  // the parser takes them in reverse order
  try {
    app.parse(std::move(tokens));
  } catch (const CLI::CallForHelp&) { throw; } catch (const CLI::ParseError& error) {
    throw bad_use(in_words(error));
  }
  refuse_leftovers(app);
}

/// Parses the options of a verb and the globals. False if help was requested; it has then been printed.
bool parse_verb(const Verb& verb, Command& command, std::vector<std::string> tokens, Io& io, Globals& globals) {
  CLI::App app(std::string(verb.summary), "collide " + std::string(verb.name));
  declare_verb(app, command, globals);
  try {
    parse_tokens(app, std::move(tokens));
  } catch (const CLI::CallForHelp&) {
    print_verb_help(io, verb, app);
    return false;
  }
  return true;
}

/// Parses the words before or without a verb, which may only be global options.
void parse_globals(std::vector<std::string> tokens, Globals& globals) {
  CLI::App app("", "collide");
  app.set_help_flag();
  declare_globals(app, globals);
  parse_tokens(app, std::move(tokens));
}

Exit run_verb(const Verb& verb, std::vector<std::string> tokens, Session& session, Globals& globals) {
  try {
    const std::unique_ptr<Command> command = make_command(verb, session.own);
    if (command == nullptr) return run_wing(session, verb.name);
    if (verb.passes_words_on) {
      for (std::string& token : tokens) token = unmarked(std::move(token));
      static_cast<PassOn&>(*command).take_words(std::move(tokens));
    } else if (!parse_verb(verb, *command, std::move(tokens), session.io, globals)) {
      return Exit::yes;
    }
    if (!globals.shards.empty() && !command->takes_shards())
      throw bad_use("it asks one server, so --shards is not for it",
                    "ask a shard alone, in its namespace: --namespace collided/shard_NAME");
    const Exit code = command->run(session, globals);
    session.io.out.flush();
    session.warn_of_strangers();
    return code;
  } catch (const Failure& failure) {
    session.io.out.flush();
    session.warn_of_strangers();
    if (failure.code != Exit::bad_use || failure.is_printed) throw;
    // A message of the library may begin with the name of its call, which is that of the verb.
    const std::string prefix = fmt::format("{}: ", verb.name);
    const std::string said = failure.what();
    throw Failure(failure.code, said.starts_with(prefix) ? said : prefix + said, failure.hint);
  }
}

/// This program's verb for a word that another program uses; empty: no such word is known.
std::string_view verb_for_word(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kWords{{{"cast", "ray"},
                                                                                         {"delete", "rm"},
                                                                                         {"find", "ls"},
                                                                                         {"info", "status"},
                                                                                         {"list", "ls"},
                                                                                         {"monitor", "watch"},
                                                                                         {"ping", "status"},
                                                                                         {"raycast", "ray"},
                                                                                         {"remove", "rm"},
                                                                                         {"show", "get"},
                                                                                         {"subscribe", "watch"},
                                                                                         {"unload", "clear"}}};
  const auto* found = std::ranges::find(kWords, word, &std::pair<std::string_view, std::string_view>::first);
  return found == kWords.end() ? std::string_view() : found->second;
}

const Verb& known_verb(const std::string& name) {
  if (const Verb* verb = find_verb(name)) return *verb;
  if (const std::string_view meant = verb_for_word(name); !meant.empty())
    throw bad_use(fmt::format("unknown verb '{}'; did you mean '{}'?", name, meant));
  std::vector<std::string> names;
  for (const Verb& verb : verbs()) names.emplace_back(verb.name);
  throw bad_use(fmt::format("unknown verb '{}'{}", name, did_you_mean(name, names)));
}

Exit run_tokens(std::vector<std::string> tokens, Session& session, Globals& globals);

/// Verbs whose words are lines of more verbs.
bool is_lines_verb(const std::string& name) { return name == "-" || name == "shell"; }

/// The lines of a pipe or file.
LineSource piped_lines(int in) {
  const auto reader = std::make_shared<LineReader>(in);
  return {.next = [reader](std::string& line) { return reader->next(line); },
          .number = [reader] { return reader->line_number(); }};
}

/// Runs the verb of one line. False if it failed, which has then been reported.
///
/// given  the words before all lines
bool run_line(const std::string& line, const LineSource& lines, const std::vector<std::string>& given, Session& session,
              const Globals& globals) {
  Globals line_globals = globals;
  session.where = lines.number ? fmt::format("line {}: ", lines.number()) : std::string();
  try {
    std::vector<std::string> words = split_words(line);
    // Lines copied from hints and help begin with the program's name.
    if (!words.empty() && words.front() == "collide") words.erase(words.begin());
    if (words.empty()) return true;
    const std::vector<std::string> tokens = prepare_tokens(words);
    session.words = given;
    session.words.insert(session.words.end(), words.begin(), words.end());
    if (is_lines_verb(tokens.front())) throw bad_use(fmt::format("'{}' has no meaning here", tokens.front()));
    run_tokens(tokens, session, line_globals);
    return true;
  } catch (const Failure& failure) {
    if (failure.code == Exit::no_server && lines.number) throw;
    if (!failure.is_printed)
      print_failure(session.io, line_globals, Failure(failure.code, session.where + failure.what(), failure.hint));
    return false;
  }
}

/// `collide -` and `collide shell`: runs a verb for each line of standard input, over one connection. A failed line is
/// reported and the next one runs.
Exit run_lines(std::vector<std::string> tokens, Session& session, Globals& globals) {
  parse_globals(tokens, globals);
  const bool is_typed = ::isatty(session.io.in) == 1;
  if (is_typed && session.own.prompted_lines == nullptr) return run_wing(session, "shell");
  const LineSource lines = is_typed ? session.own.prompted_lines(session.io) : piped_lines(session.io.in);
  for (std::string& token : tokens) token = unmarked(std::move(token));
  session.has_many_verbs = true;
  session.io.in = -1;  // the lines come from it, so the verbs must not read it
  std::string line;
  std::size_t failed = 0;
  while (!stop_requested && lines.next(line)) {
    if (!run_line(line, lines, tokens, session, globals)) ++failed;
    session.io.out.flush();
    // At a prompt, Ctrl-C ends the current verb, not the shell.
    if (is_typed) stop_requested = false;
  }
  if (stop_requested) return Exit::interrupted;
  return failed > 0 && !is_typed ? Exit::partly_refused : Exit::yes;
}

Exit run_without_verb(std::vector<std::string> tokens, Session& session, Globals& globals) {
  const auto given = [&](const char* name) { return std::find(tokens.begin(), tokens.end(), name) != tokens.end(); };
  if (given("--version")) return run_verb(known_verb("version"), {}, session, globals);
  if (!given("-h") && !given("--help")) parse_globals(std::move(tokens), globals);
  print_help(session.io);
  return Exit::yes;
}

Exit run_tokens(std::vector<std::string> tokens, Session& session, Globals& globals) {
  const std::size_t at = verb_position(tokens);
  if (at == tokens.size()) return run_without_verb(std::move(tokens), session, globals);
  const std::string name = unmarked(tokens[at]);
  tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(at));
  const auto is_help = [](const std::string& token) { return token == "-h" || token == "--help"; };
  if (is_lines_verb(name) && std::none_of(tokens.begin(), tokens.end(), is_help))
    return run_lines(std::move(tokens), session, globals);
  return run_verb(known_verb(name), std::move(tokens), session, globals);
}

}  // namespace

std::unique_ptr<Command> make_command(const Verb& verb, const OwnParts& own) {
  if (verb.make != nullptr) return verb.make();
  const auto found = std::ranges::find(own.verbs, verb.name, &OwnParts::OwnVerb::name);
  return found == own.verbs.end() ? nullptr : found->make();
}

int run(const std::vector<std::string>& arguments, Io& io, const OwnParts& own) {
  Session session(io, own);
  session.words = arguments;
  session.where = io.env(kWhereVariable);
  Globals globals;
  Exit code = Exit::yes;
  try {
    code = run_tokens(prepare_tokens(arguments), session, globals);
  } catch (const Failure& failure) {
    const std::string where = failure.code == Exit::no_server ? std::string() : session.where;
    Failure placed(failure.code, where + failure.what(), failure.hint);
    placed.is_printed = failure.is_printed;
    print_failure(io, globals, placed);
    code = failure.code;
  } catch (const std::exception& error) {
    // This program itself throws nothing else: it is out of memory, or has a bug.
    print_failure(io, globals, Failure(Exit::refused, std::string("inside collide: ") + error.what()));
    code = Exit::refused;
  }
  io.out.flush();
  io.err.flush();
  const bool an_answer = code == Exit::no || code == Exit::undecided;
  return globals.exit_zero && an_answer ? 0 : static_cast<int>(code);
}

}  // namespace collided::cli

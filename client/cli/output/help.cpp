#include "client/cli/output/help.hpp"

#include <array>

#include <fmt/format.h>

#include "client/cli/global_options.hpp"
#include "client/cli/guides/guides.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/wrapping.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/shape_text.hpp"

namespace collided::cli {
namespace {

constexpr std::array<std::string_view, 6> kGroups{"Ask", "Follow", "Change", "Look", "Files", "More"};
constexpr std::size_t kOptionColumn = 28;
constexpr std::size_t kHelpColumns = 78;
constexpr std::string_view kCommonOptions = "options";

std::string lines_after_collide(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines += fmt::format("  collide {}\n", text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string option_line(const CLI::Option& option) {
  std::string names = option.get_name(false, true);
  const std::string value = option.get_type_name();  // "AXIS:{y,z}" for a choice
  if (option.get_items_expected_max() > 0) names += " " + value.substr(0, value.find(":{"));
  std::string line = "  " + names;
  const bool has_room = line.size() + 1 < kOptionColumn;
  line += has_room ? std::string(kOptionColumn - line.size(), ' ') : '\n' + std::string(kOptionColumn, ' ');
  for (const char c : wrapped(option.get_description(), kHelpColumns - kOptionColumn, 0)) {
    line += c;
    if (c == '\n') line.append(kOptionColumn, ' ');
  }
  return line + '\n';
}

/// Prints the parser's own options or, with `common`, those that every verb has.
void print_options(Io& io, const CLI::App& app, bool common) {
  std::vector<std::string> groups;
  for (const CLI::Option* option : app.get_options()) {
    const bool known = std::find(groups.begin(), groups.end(), option->get_group()) != groups.end();
    const bool is_common = option->get_group() == kOutputGroup || option->get_group() == kConnectionGroup;
    if (!known && !option->get_group().empty() && is_common == common) groups.push_back(option->get_group());
  }
  for (const std::string& group : groups) {
    std::string lines;
    for (const CLI::Option* option : app.get_options()) {
      const bool positional = option->get_positional();
      const bool is_help = option->get_name(false, true) == "-h,--help";
      if (option->get_group() == group && !positional && !is_help) lines += option_line(*option);
    }
    if (!lines.empty()) io.out << '\n' << group << '\n' << lines;
  }
}

/// The names of the guides in lines of a terminal.
std::string guide_lines() {
  std::string text;
  std::string line = "Guides  ";
  for (const Guide& guide : guides()) {
    if (line.size() + 1 + guide.name.size() > kHelpColumns) {
      text += line + '\n';
      line = std::string(std::string_view("Guides  ").size(), ' ');
    }
    line += ' ' + std::string(guide.name);
  }
  return text + line + '\n';
}

void print_common_options(Io& io) {
  io.out << "Options that every verb has\n";
  CLI::App app("", "collide");
  app.set_help_flag();
  Globals ignored;
  declare_globals(app, ignored);
  print_options(io, app, true);
}

class HelpCommand : public Command {
 public:
  void declare(CLI::App& app) override { option(app, "verb TOPIC", verb_, "Verb to explain, or guide to read"); }
  Exit run(Session& session, const Globals& globals) override {
    if (verb_.empty()) {
      print_help(session.io);
      return Exit::yes;
    }
    if (verb_ == kCommonOptions) {
      print_common_options(session.io);
      return Exit::yes;
    }
    if (const auto guide = std::ranges::find(guides(), verb_, &Guide::name); guide != guides().end()) {
      session.io.out << guide->text;
      return Exit::yes;
    }
    const Verb* verb = find_verb(verb_);
    if (verb == nullptr) {
      std::vector<std::string> names;
      for (const Verb& known : verbs()) names.emplace_back(known.name);
      for (const Guide& known : guides()) names.emplace_back(known.name);
      throw bad_use(fmt::format("no verb '{}'{}", verb_, did_you_mean(verb_, names)));
    }
    CLI::App app(std::string(verb->summary), "collide");
    const std::unique_ptr<Command> command = make_command(*verb, session.own);
    if (command == nullptr) return run_wing(session, verb->name);
    if (verb->passes_words_on && !verb->group.empty()) {
      static_cast<PassOn&>(*command).take_words({"--help"});
      return command->run(session, globals);
    }
    Globals ignored;
    declare_verb(app, *command, ignored);
    print_verb_help(session.io, *verb, app);
    return Exit::yes;
  }

 private:
  std::string verb_;
};

}  // namespace

void print_help(Io& io) {
  io.out << "collide - ask a collision server about rays, spheres and boxes\n\n"
            "  collide ray 0 0 5  0 0 -1          first thing below (0 0 5)\n"
            "  collide watch                      collisions as they begin and end\n\n";
  constexpr std::size_t kIndent = 9;
  constexpr std::size_t kTerminalColumns = 80;
  for (const std::string_view group : kGroups) {
    std::string line = fmt::format("{:<{}}", group, kIndent - 2);
    const auto put = [&](std::string_view words) {
      if (line.size() + 2 + words.size() > kTerminalColumns) {
        io.out << line << '\n';
        line = std::string(kIndent - 2, ' ');
      }
      line += "  " + std::string(words);
    };
    for (const Verb& verb : verbs()) {
      if (verb.group == group) put(verb.name);
    }
    if (group == kGroups.back()) put("collide help VERB|GUIDE");
    io.out << line << '\n';
  }
  io.out << guide_lines();
}

void print_verb_help(Io& io, const Verb& verb, const CLI::App& app) {
  io.out << wrapped(fmt::format("collide {} - {}", verb.name, verb.summary), kHelpColumns) << "\n\n"
         << lines_after_collide(verb.usage);
  if (verb.takes_shape) io.out << "\nShapes\n" << kShapeTable;
  print_options(io, app, false);
  if (!verb.examples.empty()) io.out << "\nExamples\n" << lines_after_collide(verb.examples);
  io.out << "\nOutput and connection: collide help options\n";
}

std::unique_ptr<Command> make_help() { return std::make_unique<HelpCommand>(); }

}  // namespace collided::cli

#include "client/cli/output/help.hpp"

#include <array>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/global_options.hpp"
#include "client/cli/output/suggest.hpp"

namespace collided::cli {
namespace {

constexpr std::array<std::string_view, 7> kGroups{"Ask", "Follow", "Change", "Look", "Measure", "Files", "More"};
constexpr std::size_t kOptionColumn = 28;

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
  if (option.get_items_expected_max() > 0) names += " ...";
  std::string line = "  " + names;
  line += line.size() + 1 < kOptionColumn ? std::string(kOptionColumn - line.size(), ' ') : "  ";
  return line + option.get_description() + '\n';
}

class HelpCommand : public Command {
 public:
  void declare(CLI::App& app) override { app.add_option("verb", verb_, "Verb to explain"); }
  Exit run(Session& session, const Globals&) override {
    if (verb_.empty()) {
      print_help(session.io);
      return Exit::yes;
    }
    const Verb* verb = find_verb(verb_);
    if (verb == nullptr) {
      std::vector<std::string> names;
      for (const Verb& known : verbs()) names.emplace_back(known.name);
      throw bad_use(fmt::format("no verb '{}'{}", verb_, did_you_mean(verb_, names)));
    }
    CLI::App app(std::string(verb->summary), "collide");
    const std::unique_ptr<Command> command = verb->make();
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
  for (const std::string_view group : kGroups) {
    std::string names;
    for (const Verb& verb : verbs()) {
      if (verb.group == group) names += (names.empty() ? "" : "  ") + std::string(verb.name);
    }
    const bool last = group == kGroups.back();
    if (last) names = fmt::format("{:<42}collide help VERB", names);
    if (!names.empty()) io.out << fmt::format("{:<9}{}\n", group, names);
  }
}

void print_verb_help(Io& io, const Verb& verb, const CLI::App& app) {
  io.out << "collide " << verb.name << " - " << verb.summary << "\n\n" << lines_after_collide(verb.usage);
  std::vector<std::string> groups;
  for (const CLI::Option* option : app.get_options()) {
    const bool known = std::find(groups.begin(), groups.end(), option->get_group()) != groups.end();
    if (!known && !option->get_group().empty()) groups.push_back(option->get_group());
  }
  for (const std::string& group : groups) {
    std::string lines;
    for (const CLI::Option* option : app.get_options()) {
      const bool positional = option->get_positional();
      if (option->get_group() == group && !positional) lines += option_line(*option);
    }
    if (!lines.empty()) io.out << '\n' << group << '\n' << lines;
  }
  if (!verb.examples.empty()) io.out << "\nExamples\n" << lines_after_collide(verb.examples);
}

std::unique_ptr<Command> make_help() { return std::make_unique<HelpCommand>(); }

}  // namespace collided::cli

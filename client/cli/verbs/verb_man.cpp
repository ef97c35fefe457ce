#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/global_options.hpp"
#include "client/cli/guides/man_page.hpp"
#include "client/cli/input/line_reader.hpp"
#include "client/cli/output/help.hpp"
#include "client/cli/output/suggest.hpp"

namespace collided::cli {
namespace {

/// What a verb's help says, as `collide help VERB` prints it to a pipe.
std::string help_of(const Verb& verb) {
  std::ostringstream text, unused;
  Io io{.out = text, .err = unused, .environment = {}};
  CLI::App app(std::string(verb.summary), "collide");
  const std::unique_ptr<Command> command = verb.make();
  Globals ignored;
  declare_verb(app, *command, ignored);
  print_verb_help(io, verb, app);
  // Another program has the options of these, and says them itself.
  if (verb.passes_words_on) text << "Options: collide help " << verb.name << '\n';
  return text.str();
}

std::string guides_section() {
  std::string text = man_section("SEE ALSO") + ".BR collided (1)";
  for (const Guide& guide : guides()) text += fmt::format(",\n.BR collided\\-{} (7)", guide.name);
  return text + '\n';
}

/// collide(1), from what `collide help` says of itself and of each verb.
std::string man_of_collide() {
  std::ostringstream overview, common, unused;
  Io overview_io{.out = overview, .err = unused, .environment = {}};
  Io common_io{.out = common, .err = unused, .environment = {}};
  print_help(overview_io);
  print_common_options(common_io);
  std::string page = man_head("collide", 1, "collide", "ask a collision server about rays, spheres and boxes");
  page += man_section("SYNOPSIS") + ".B collide\n[options]\n.I VERB\n[arguments]\n";
  page += man_section("DESCRIPTION") + man_as_is(overview.str());
  page += man_section("OPTIONS") + man_as_is(common.str());
  page += man_section("VERBS");
  for (const Verb& verb : verbs()) {
    if (!verb.group.empty()) page += fmt::format(".SS {}\n{}", verb.name, man_as_is(help_of(verb)));
  }
  page +=
      man_section("EXIT STATUS") +
      man_as_is(
          "0    yes, or done\n1    no: a miss, a free path, nothing matched\n2    bad use; nothing was sent\n"
          "3    undecided\n4    no server answered\n5    the server refused\n6    some lines of a batch were refused\n"
          "130  interrupted\n");
  return page + guides_section();
}

/// collided(1), from what `collided --help` printed.
std::string man_of_collided(const std::string& help) {
  return man_head("collided", 1, "collided", "a collision query service on DDS") + man_section("SYNOPSIS") +
         ".B collided\n[\n.I SCENE\n\\&...]\n" + man_section("DESCRIPTION") + man_as_is(help) + guides_section();
}

class ManCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "topic", topic_, "Guide; without: collide itself");
    app.add_flag("--server", of_server_, "Of collided, from the output of 'collided --help' on standard input");
  }

  Exit run(Session& session, const Globals&) override {
    if (of_server_) {
      session.io.out << man_of_collided(all_of(session.io.in));
    } else if (topic_.empty()) {
      session.io.out << man_of_collide();
    } else if (const Guide* guide = find_guide(topic_)) {
      session.io.out << man_page(*guide);
    } else {
      std::vector<std::string> names;
      for (const Guide& known : guides()) names.emplace_back(known.name);
      throw bad_use(fmt::format("no guide '{}'{}", topic_, did_you_mean(topic_, names)));
    }
    return Exit::yes;
  }

 private:
  static std::string all_of(int descriptor) {
    LineReader lines(descriptor);
    std::string text;
    for (std::string line; lines.next(line);) text += line + '\n';
    return text;
  }

  std::string topic_;
  bool of_server_ = false;
};

}  // namespace

std::unique_ptr<Command> make_man() { return std::make_unique<ManCommand>(); }

}  // namespace collided::cli

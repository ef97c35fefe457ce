#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/input/line_reader.hpp"
#include "client/cli/session.hpp"

namespace CLI {
class App;
}

namespace collided::cli {

/// One verb of one command line. declare() declares its options on the parser, which fills the members; then run() does
/// the work. It throws Failure on error. One thread.
class Command {
 public:
  virtual ~Command() = default;
  virtual void declare(CLI::App& app) = 0;
  virtual Exit run(Session& session, const Globals& globals) = 0;
  /// Whether it works with several servers, by --shards.
  virtual bool takes_shards() const { return false; }
};

/// A verb in the table of verbs: its help, and how to make its command.
struct Verb {
  std::string_view name;
  std::string_view group;  // heading in the help; empty: the help does not list it
  std::string_view summary;
  std::string_view usage;              // one form a line, without "collide"
  std::string_view examples;           // lines as typed after "collide "
  std::unique_ptr<Command> (*make)();  // null: the verb is in a program of its own, collide-NAME (client/cli/programs)
  bool passes_words_on = false;        // its words are not parsed here but passed to another program or completed
  bool takes_shape = false;            // its help lists the shapes
};

/// All verbs, in the order of the help.
std::span<const Verb> verbs();
/// The verb of that name, or null.
const Verb* find_verb(std::string_view name);

/// The parts of a program of client/cli/programs beyond the verbs that all programs have. `collide` itself has none, so
/// that it loads no library that only some verbs need.
struct OwnParts {
  struct OwnVerb {
    std::string_view name;
    std::unique_ptr<Command> (*make)();
  };
  std::vector<OwnVerb> verbs = {};
  LineSource (*prompted_lines)(const Io&) = nullptr;  // lines typed at a prompt
};

/// The verb's command. Null if another program has it (run_wing).
std::unique_ptr<Command> make_command(const Verb& verb, const OwnParts& own);

/// Runs the program collide-NAME with the words of this line: replacing this process, or as a child if lines of
/// `collide -` follow. Throws Failure if it is missing, and one without a message if the child has printed its own.
Exit run_wing(const Session& session, std::string_view name);

// One function for each verb, defined in client/cli/verbs or client/cli/programs.
std::unique_ptr<Command> make_completion();
std::unique_ptr<Command> make_complete();
std::unique_ptr<Command> make_ray();
std::unique_ptr<Command> make_sphere();
std::unique_ptr<Command> make_box();
std::unique_ptr<Command> make_near();
std::unique_ptr<Command> make_inside();
std::unique_ptr<Command> make_sweep();
std::unique_ptr<Command> make_pair_verb();
std::unique_ptr<Command> make_clearance();
std::unique_ptr<Command> make_clash();
std::unique_ptr<Command> make_what_if();
std::unique_ptr<Command> make_watch();
std::unique_ptr<Command> make_probe();
std::unique_ptr<Command> make_top();
std::unique_ptr<Command> make_metrics();
std::unique_ptr<Command> make_ros();
std::unique_ptr<Command> make_view();
std::unique_ptr<Command> make_add();
std::unique_ptr<Command> make_move();
std::unique_ptr<Command> make_rm();
std::unique_ptr<Command> make_publish();
std::unique_ptr<Command> make_load();
std::unique_ptr<Command> make_clear();
std::unique_ptr<Command> make_allow();
std::unique_ptr<Command> make_deny();
std::unique_ptr<Command> make_attach();
std::unique_ptr<Command> make_detach();
std::unique_ptr<Command> make_accept_loss();
std::unique_ptr<Command> make_status();
std::unique_ptr<Command> make_ls();
std::unique_ptr<Command> make_get();
std::unique_ptr<Command> make_plan();
std::unique_ptr<Command> make_draw();
std::unique_ptr<Command> make_menu();
std::unique_ptr<Command> make_audit();
std::unique_ptr<Command> make_check();
std::unique_ptr<Command> make_convert();
std::unique_ptr<Command> make_implicit();
std::unique_ptr<Command> make_doctor();
std::unique_ptr<Command> make_fleet();
std::unique_ptr<Command> make_handover();
std::unique_ptr<Command> make_fence();
std::unique_ptr<Command> make_margin();
std::unique_ptr<Command> make_nearest();
std::unique_ptr<Command> make_keys();
std::unique_ptr<Command> make_record();
std::unique_ptr<Command> make_snapshot();
std::unique_ptr<Command> make_replay();
std::unique_ptr<Command> make_explain();
std::unique_ptr<Command> make_events();
std::unique_ptr<Command> make_demo();
std::unique_ptr<Command> make_shell();
std::unique_ptr<Command> make_help();
std::unique_ptr<Command> make_version();

/// A verb whose words are not parsed here, such as check, convert and implicit: take_words() receives them before
/// run().
class PassOn : public Command {
 public:
  virtual void take_words(std::vector<std::string> words) = 0;
};

}  // namespace collided::cli

#include <algorithm>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/global_options.hpp"
#include "client/cli/guides/guides.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {

namespace wire = wire_contract::command;
namespace {

constexpr std::string_view kBash =
    R"(# collide completion bash: source it, or put it into /etc/bash_completion.d
_collide() {
  local IFS=$'\n'
  COMPREPLY=($(collide complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -F _collide collide
)";

constexpr std::string_view kZsh =
    R"(#compdef collide
# collide completion zsh: put it as _collide into a folder of $fpath
_collide() {
  local -a found
  found=("${(@f)$(collide complete -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  if [[ -n $found ]]; then compadd -a found; else _files; fi
}
compdef _collide collide
)";

constexpr std::string_view kFish =
    R"(# collide completion fish: put it into ~/.config/fish/completions/collide.fish
complete -c collide -a '(collide complete -- (commandline -opc)[2..-1] (commandline -ct) 2>/dev/null)'
)";

class CompletionCommand : public Command {
 public:
  void declare(CLI::App& app) override { app.add_option("shell", shell_, "bash, zsh or fish"); }

  Exit run(Session& session, const Globals&) override {
    if (shell_ == "bash") session.io.out << kBash;
    else if (shell_ == "zsh") session.io.out << kZsh;
    else if (shell_ == "fish") session.io.out << kFish;
    else throw bad_use(shell_.empty() ? "for which shell?" : fmt::format("no shell '{}'", shell_), "bash, zsh or fish");
    return Exit::yes;
  }

 private:
  std::string shell_;
};

/// Prints the completions of the last word, one a line; none where it may be a file.
class CompleteCommand : public PassOn {
 public:
  void declare(CLI::App&) override {}
  void take_words(std::vector<std::string> words) override {
    if (!words.empty() && words.front() == "--") words.erase(words.begin());
    words_ = std::move(words);
  }

  Exit run(Session& session, const Globals& globals) override {
    if (words_.empty()) words_.emplace_back();
    const std::string typed = words_.back();
    words_.pop_back();
    for (const std::string& candidate : candidates(session, globals, typed)) {
      if (candidate.starts_with(typed)) session.io.out << candidate << '\n';
    }
    return Exit::yes;
  }

 private:
  std::vector<std::string> candidates(Session& session, const Globals& globals, const std::string& typed) const {
    const auto verb_name = std::find_if(words_.begin(), words_.end(), [](const auto& w) { return find_verb(w); });
    if (verb_name == words_.end()) return verb_names();
    const Verb& verb = *find_verb(*verb_name);
    if (verb.name == "help") return help_topics();
    if (verb.name == "completion") return {"bash", "zsh", "fish"};
    if (typed.starts_with("-")) return options_of(verb);
    if (verb.name == "explain" && words_.back() == verb.name) return {"pair", "ray", "fence", "event"};
    const std::string& before = words_.back();
    const bool wants_object = before == "--only" || before == "--skip" || before == "--on" || before == "--to" ||
                              before == "--against" || before == "--why-not" || before == verb.name ||
                              verb.name == "pair" || verb.name == "explain" || verb.name == "rm" ||
                              verb.name == "allow" || verb.name == "deny" || verb.name == "attach";
    constexpr std::array<std::string_view, 12> kByName{"allow",   "attach", "clash", "clearance", "deny", "detach",
                                                       "explain", "get",    "ls",    "move",      "pair", "rm"};
    const bool takes_object = std::ranges::find(kByName, verb.name) != kByName.end();
    const bool is_option = before.starts_with("-");
    return wants_object && (takes_object || is_option) ? objects(session, globals) : std::vector<std::string>();
  }

  static std::vector<std::string> verb_names() {
    std::vector<std::string> names;
    for (const Verb& verb : verbs()) {
      if (!verb.group.empty()) names.emplace_back(verb.name);
    }
    return names;
  }

  static std::vector<std::string> help_topics() {
    std::vector<std::string> names = verb_names();
    for (const Guide& guide : guides()) names.emplace_back(guide.name);
    return names;
  }

  static std::vector<std::string> options_of(const Verb& verb) {
    CLI::App app("", "collide");
    const std::unique_ptr<Command> command = verb.make();
    Globals ignored;
    declare_verb(app, *command, ignored);
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
  }

  /// The names of objects, if a server answers at once.
  static std::vector<std::string> objects(Session& session, Globals globals) {
    if (globals.wait.empty()) globals.wait = "500ms";
    std::vector<std::string> names;
    try {
      const nlohmann::json answer = server_command(session, globals, wire::kList, {{"name", ""}, {"limit", 10'000}});
      for (const nlohmann::json& object : answer.value("objects", nlohmann::json::array()))
        names.push_back(text_of(object, "name"));
    } catch (const Failure&) {
      // Without a server there are no names, and a message would appear in the middle of the command line.
    }
    return names;
  }

  std::vector<std::string> words_;
};

}  // namespace

std::unique_ptr<Command> make_completion() { return std::make_unique<CompletionCommand>(); }
std::unique_ptr<Command> make_complete() { return std::make_unique<CompleteCommand>(); }

}  // namespace collided::cli

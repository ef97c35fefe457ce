#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
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
  void declare(CLI::App& app) override { option(app, "shell bash|zsh|fish", shell_, "bash, zsh or fish"); }

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

/// Prints the completions of the last word, one a line; none if it may be a file.
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
    const auto verb_word = std::find_if(words_.begin(), words_.end(), [](const auto& w) { return find_verb(w); });
    const Verb* verb = verb_word == words_.end() ? nullptr : find_verb(*verb_word);
    const std::unique_ptr<Command> command = verb == nullptr ? nullptr : make_command(*verb, session.own);
    if (verb != nullptr && command == nullptr) return run_wing(session, verb->name);
    const auto place = static_cast<std::size_t>(words_.end() - verb_word);
    for (const std::string& candidate : candidates(session, globals, command.get(), place, typed)) {
      if (candidate.starts_with(typed)) session.io.out << candidate << '\n';
    }
    return Exit::yes;
  }

 private:
  /// Candidates for that word after the verb of the command (null: there is no verb yet).
  std::vector<std::string> candidates(Session& session, const Globals& globals, Command* command, std::size_t place,
                                      const std::string& typed) const {
    if (command == nullptr) return verb_names();
    CLI::App app("", "collide");
    Globals ignored;
    declare_verb(app, *command, ignored);
    if (typed.starts_with("-")) return option_names(app);
    const std::string value = value_of_next(app, place - 1);
    if (value == "GLOB" || value == "OBJECT") return objects(session, globals);
    if (value == "TOPIC") return help_topics();
    if (const std::size_t choices = value.find('{'); choices != std::string::npos)
      return CLI::detail::split(value.substr(choices + 1, value.size() - choices - 2), ',');
    return value.find('|') == std::string::npos ? std::vector<std::string>() : CLI::detail::split(value, '|');
  }

  /// The value name of the next word, after this many of the verb's words.
  std::string value_of_next(const CLI::App& app, std::size_t word_count) const {
    const CLI::Option* before = app.get_option_no_throw(words_.back());
    if (before != nullptr && !before->get_positional() && before->get_items_expected_max() > 0)
      return before->get_type_name();
    for (const CLI::Option* option : app.get_options([](const CLI::Option* one) { return one->get_positional(); })) {
      const auto most = static_cast<std::size_t>(option->get_items_expected_max());
      const std::vector<std::string> names = CLI::detail::split(option->get_type_name(), ' ');
      if (word_count < most) return names[std::min(word_count, names.size() - 1)];
      word_count -= most;
    }
    return {};
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

  /// The names of objects, if a server answers at once.
  static std::vector<std::string> objects(Session& session, Globals globals) {
    if (!globals.wait) globals.wait = std::chrono::milliseconds(500);
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

#include "client/cli/command.hpp"
#include "client/cli/files_program.hpp"
#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

/// A verb that reads files. Only the server's code reads files, and this program does not contain it, so another
/// program does the work.
class FilesCommand : public PassOn {
 public:
  /// joins_values  whether a negative number after an option is the option's value
  FilesCommand(const char* verb, bool joins_values) : verb_(verb), joins_values_(joins_values) {}

  void declare(CLI::App&) override {}

  void take_words(std::vector<std::string> words) override {
    for (std::size_t at = 0; at < words.size(); ++at) {
      // A value that begins with a minus sign is joined to its option.
      const bool value_follows = joins_values_ && words[at].starts_with("--") && at + 1 < words.size() &&
                                 words[at + 1].starts_with("-") && is_number_text(words[at + 1]);
      words_.push_back(value_follows ? words[at] + "=" + words[at + 1] : words[at]);
      if (value_follows) ++at;
    }
  }

  Exit run(Session& session, const Globals&) override {
    std::vector<std::string> words{verb_};
    words.insert(words.end(), words_.begin(), words_.end());
    return static_cast<Exit>(run_files_program(session.io, std::move(words)));
  }

 private:
  const char* verb_;
  bool joins_values_;
  std::vector<std::string> words_;
};

}  // namespace

std::unique_ptr<Command> make_check() { return std::make_unique<FilesCommand>("check", true); }
std::unique_ptr<Command> make_convert() { return std::make_unique<FilesCommand>("convert", true); }
std::unique_ptr<Command> make_implicit() { return std::make_unique<FilesCommand>("implicit", false); }

}  // namespace collided::cli

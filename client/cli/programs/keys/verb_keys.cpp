#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/option.hpp"
#include "client/keys/authority.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::cli {
namespace {

keys::Protection protection_of(const std::string& text) {
  for (const keys::Protection one : {keys::Protection::none, keys::Protection::sign, keys::Protection::encrypt}) {
    if (text == keys::name_of(one)) return one;
  }
  throw bad_use(fmt::format("no protection '{}'", text), "none, sign or encrypt");
}

std::vector<keys::KeyRole> roles_of(const std::vector<std::string>& texts) {
  std::vector<keys::KeyRole> roles;
  for (const std::string& text : texts) {
    const std::optional<keys::KeyRole> role = keys::role_of(text);
    if (!role) throw bad_use(fmt::format("no role '{}'", text), "server, standby, publisher, asker, watcher or admin");
    roles.push_back(*role);
  }
  return roles;
}

std::string_view finding_name(keys::KeyFinding::Kind kind) {
  switch (kind) {
    case keys::KeyFinding::Kind::good: return "ok";
    case keys::KeyFinding::Kind::soon: return "soon";
    case keys::KeyFinding::Kind::wrong: break;
  }
  return "wrong";
}

/// The two words that follow the verb: an action, and a name or folder.
class KeysCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "action init|add|revoke|check NAME", action_, "init, add, revoke or check");
    option(app, "what", what_, "init: the folder to make; add, revoke: whom");
    option(app, "--dir DIR", folder_, "Folder of the authority ('keys')");
    option(app, "--role ROLE", roles_, "server, standby, publisher, asker, watcher, admin; repeatable, they add up")
        ->allow_extra_args(false)
        ->delimiter(',');
    option(app, "--objects GLOB", objects_, "Only names that match this glob; repeatable (all)")
        ->allow_extra_args(false);
    option(app, "--days N", days_, "How long the keys are good (90)");
    option(app, "--protection KIND", protection_, "init: none, sign or encrypt (encrypt)");
  }

  Exit run(Session& session, const Globals& globals) override {
    try {
      return act(session, globals);
    } catch (const keys::KeyError& wrong) { throw bad_use(wrong.what()); }
  }

 private:
  Exit act(Session& session, const Globals& globals) {
    Printer printer = make_printer(session.io, globals);
    if (action_ == "init") return init(printer);
    if (action_ == "add") return add(printer);
    if (action_ == "revoke") return revoke(printer);
    if (action_ == "check") return check(printer);
    throw bad_use(action_.empty() ? "what is to be done?" : fmt::format("'{}' is nothing to do", action_),
                  "init, add, revoke or check");
  }

  const std::string& whom() const {
    if (what_.empty()) throw bad_use("whose keys?", fmt::format("collide keys {} NAME", action_));
    return what_;
  }

  Exit init(Printer& printer) const {
    const std::string folder = what_.empty() ? folder_ : what_;
    keys::Authority::init(folder, protection_of(protection_));
    if (printer.human()) {
      printer.line(fmt::format("made two authorities in {}/authority; who can read that folder can make any keys",
                               printable(folder)));
    } else {
      printer.record({{"folder", folder}, {"protection", protection_}});
    }
    return Exit::yes;
  }

  Exit add(Printer& printer) const {
    const std::string made = keys::Authority(folder_).add(whom(), roles_of(roles_), objects_, days_);
    const std::string until = keys::date_text(keys::check_keys(made).until_s);
    if (printer.human()) {
      printer.line(fmt::format("made {}, good until {}; copy it to where {} runs, and name it there by --keys",
                               printable(made), until, printable(what_)));
    } else {
      printer.record({{"folder", made}, {"name", what_}, {"until", until}});
    }
    return Exit::yes;
  }

  Exit revoke(Printer& printer) const {
    const std::size_t count = keys::Authority(folder_).revoke(whom());
    if (printer.human()) {
      printer.line(
          fmt::format("revoked {} certificate{} of {}; copy the new {} from any folder to those in use: a "
                      "server reads it within a second, others at their next start",
                      count, count == 1 ? "" : "s", printable(what_), keys::kRevoked));
    } else {
      printer.record({{"name", what_}, {"revoked", static_cast<std::uint64_t>(count)}});
    }
    return Exit::yes;
  }

  Exit check(Printer& printer) const {
    Exit code = Exit::yes;
    for (const keys::KeyFinding& finding : keys::Authority(folder_).check()) {
      const std::string word(finding_name(finding.kind));
      if (printer.human()) {
        const Paint paint = finding.kind == keys::KeyFinding::Kind::good   ? Paint::good
                            : finding.kind == keys::KeyFinding::Kind::soon ? Paint::doubt
                                                                           : Paint::bad;
        printer.line(printer.paint(paint, word) + std::string(7 - word.size(), ' ') +
                     printable(finding.name + ": " + finding.text));
      } else {
        printer.record({{"state", word}, {"name", finding.name}, {"text", finding.text}});
      }
      if (finding.kind == keys::KeyFinding::Kind::wrong) code = Exit::no;
    }
    printer.finish();
    return code;
  }

  std::string action_;
  std::string what_;
  std::string folder_ = "keys";
  std::vector<std::string> roles_;
  std::vector<std::string> objects_;
  int days_ = 90;
  std::string protection_ = "encrypt";
};

}  // namespace

std::unique_ptr<Command> make_keys() { return std::make_unique<KeysCommand>(); }

}  // namespace collided::cli

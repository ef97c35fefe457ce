#pragma once

#include <optional>
#include <utility>

#include "server/service/commands/commands.hpp"

namespace collided::engine::service {

/// Has a command answered on the thread for pairs, or, where it costs much, on the one for what is costly. The arguments
/// are checked before; what they name is looked up in the state of the moment in which the work begins.
///
/// find   what is asked, with its cost; throws BadCommand
/// work   the answer
template <class Asked>
void Commands::in_turn(CommandAsk ask, const Arguments& arguments, const char* what,
                       Asked (Commands::*find)(const AwaitedJob&) const,
                       nlohmann::json (Commands::*work)(const Asked&) const) {
  const std::uint64_t client = ask.client;
  const std::uint64_t request = ask.request;
  const auto refuse = [this, client, request](const std::string& error, const std::string& hint) {
    answering_->send_text(client, request, wire_contract::ReplyStatus::refused, refusal_text(error, hint));
  };
  const auto answer_cheap_or_pass_on = [this, what, find, work, refuse](const std::shared_ptr<AwaitedJob>& job) {
    if (!is_wanted(*job)) return;
    std::optional<Asked> asked;
    try {
      asked.emplace((this->*find)(*job));
      if (asked->cost > kCheapCost) {
        const Share share{.client = job->ask.client, .cost = asked->cost};
        asked.reset();  // a state must not be held while the job waits
        return push_fairly(what, costly_jobs_, share, [this, job, find, work] {
          if (!is_wanted(*job)) return;
          answer(job->ask, [&] { return finished(*job, [&] { return (this->*work)((this->*find)(*job)); }); });
        });
      }
    } catch (const BadCommand& bad) { return refuse(bad.what(), bad.hint); } catch (const std::exception& failed) {
      return refuse(failed.what(), "");
    }
    answer(job->ask, [&] { return finished(*job, [&] { return (this->*work)(*asked); }); });
  };
  const auto job = await(std::move(ask), arguments);
  push_fairly(what, pair_jobs_, {.client = client}, [answer_cheap_or_pass_on, job] { answer_cheap_or_pass_on(job); });
}

}  // namespace collided::engine::service

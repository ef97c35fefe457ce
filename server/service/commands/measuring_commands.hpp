#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "server/service/commands/command_family.hpp"
#include "server/world/audit/menu.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/explain/standing_explanation.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/world/groups/clearance.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine::service {

/// Measurements and explanations, on the threads for long commands; each answer may be called off.
class MeasuringCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;

  std::vector<BoundCommand> commands() override;
  void look_for_gone() override;
  /// Waits a moment for the jobs under way, then ends the rest at once.
  void stop() override;

 private:
  /// A command's question, and when its answer is needed no more (steady clock), or that its client has gone.
  struct AwaitedJob {
    CommandAsk ask;
    std::int64_t deadline_ns = 0;
    std::atomic<bool> called_off{false};

    bool is_over() const { return called_off.load() || (deadline_ns != 0 && steady_ns() > deadline_ns); }
  };
  /// The state that a command asks about, and about how many triangles the answer examines.
  struct AskedState {
    SnapshotRing::Lease newest;
    std::shared_ptr<const Snapshot> past = nullptr;  // null: the newest is asked about
    double cost = 0;

    const Snapshot& state() const { return past ? *past : *newest; }
  };
  struct AskedPair : AskedState {
    ObjectId a = 0;
    ObjectId b = 0;
    PairAsk options = {};
    bool is_fcl_asked = false;
    std::int64_t since_ns = 0;  // world time; of an explanation
  };
  struct AskedGroups : AskedState {
    ClearanceAsk options = {};
  };
  struct AskedRay : AskedState {
    RayExplanationAsk options = {};
    std::int64_t deadline_ns = 0;
    const std::atomic<bool>* called_off = nullptr;
  };
  struct AskedEvent {
    RecentEvent recent;
    bool is_of_fence = false;
    std::int64_t deadline_ns = 0;
    const std::atomic<bool>* called_off = nullptr;
    double cost = 0;
  };
  /// A command up to this cost takes a few milliseconds at most if its surfaces are not close everywhere, and about 50
  /// ms if they are; costlier ones have a thread of their own.
  static constexpr double kCheapCost = 4'000;
  /// Certificates and lists of triangles take this many times longer.
  static constexpr double kDetailCost = 8;

  std::shared_ptr<AwaitedJob> await(CommandAsk ask, const Arguments& arguments);
  bool is_wanted(const AwaitedJob& job) const;
  nlohmann::json finished(const AwaitedJob& job, const std::function<nlohmann::json()>& work) const;
  std::shared_ptr<const Snapshot> past_state(const Arguments& arguments, const Snapshot& newest) const;
  template <class Asked>
  void in_turn(CommandAsk ask, const Arguments& arguments, const char* what,
               Asked (MeasuringCommands::*find)(const AwaitedJob&) const,
               nlohmann::json (MeasuringCommands::*work)(const Asked&) const);

  void pair_later(CommandAsk ask, const Arguments& arguments);
  AskedPair asked_pair(const AwaitedJob& job) const;
  nlohmann::json examined(const AskedPair& asked) const;
  void clearance_later(CommandAsk ask, const Arguments& arguments);
  AskedGroups asked_groups(const AwaitedJob& job) const;
  nlohmann::json measured(const AskedGroups& asked) const;
  void explain_later(CommandAsk ask, const Arguments& arguments);
  AskedPair asked_explanation(const AwaitedJob& job) const;
  nlohmann::json explained(const AskedPair& asked) const;
  AskedRay asked_ray(const AwaitedJob& job) const;
  nlohmann::json explained_ray(const AskedRay& asked) const;
  void explain_standing_later(CommandAsk ask);
  void explain_standing_of(const CommandAsk& ask);
  nlohmann::json explained_standing(const StandingLook& look, const AwaitedJob& job) const;
  AskedEvent asked_event(const AwaitedJob& job) const;
  nlohmann::json explained_event(const AskedEvent& asked) const;
  void menu_later(CommandAsk ask, const Arguments& arguments);
  nlohmann::json menu(const MenuOptions& options, const AwaitedJob& job) const;
  nlohmann::json audit() const;

  std::mutex awaited_mutex_;
  std::vector<std::weak_ptr<AwaitedJob>> awaited_;  // those not yet answered, and some that are
};

/// Answers a command on the thread for pairs, or, if it costs much, on the one for costly commands. The arguments are
/// checked before; objects are looked up in the state of the moment at which the work begins.
///
/// find  the question with its cost; throws BadCommand
/// work  the answer
template <class Asked>
void MeasuringCommands::in_turn(CommandAsk ask, const Arguments& arguments, const char* what,
                                Asked (MeasuringCommands::*find)(const AwaitedJob&) const,
                                nlohmann::json (MeasuringCommands::*work)(const Asked&) const) {
  const auto answer_cheap_or_pass_on = [this, what, find, work](const std::shared_ptr<AwaitedJob>& job) {
    if (!is_wanted(*job)) return;
    std::optional<Asked> asked;
    try {
      asked.emplace((this->*find)(*job));
      if (asked->cost > kCheapCost) {
        const Share share{.client = job->ask.client, .cost = asked->cost};
        asked.reset();  // a state must not be held while the job waits
        return threads_.push_costly(what, share, [this, job, find, work] {
          if (!is_wanted(*job)) return;
          answers_.answer(job->ask, [&] { return finished(*job, [&] { return (this->*work)((this->*find)(*job)); }); });
        });
      }
    } catch (const BadCommand& bad) { return answers_.refuse(job->ask, bad); } catch (const std::exception& failed) {
      return answers_.refuse(job->ask, failed.what());
    }
    answers_.answer(job->ask, [&] { return finished(*job, [&] { return (this->*work)(*asked); }); });
  };
  const Share share{.client = ask.client};
  const auto job = await(std::move(ask), arguments);
  threads_.push_pair(what, share, [answer_cheap_or_pass_on, job] { answer_cheap_or_pass_on(job); });
}

}  // namespace collided::engine::service

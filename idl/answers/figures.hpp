#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/answers/commands.hpp"
#include "idl/described.hpp"

/// Statistics of a server: the answers of the commands `figures` and `steps`.
namespace collided {

/// Number of durations above the previous row's longest_ns and at most this one's.
struct DurationStep {
  std::int64_t longest_ns = 0;
  std::uint64_t count = 0;
};
template <>
inline constexpr bool kIsRow<DurationStep> = true;
constexpr auto fields_of(const DurationStep*) { return fields<&DurationStep::longest_ns, &DurationStep::count>(); }

/// A stage of the world's steps and the time it took.
struct StageTime {
  std::string stage;
  std::uint64_t ns = 0;
};
constexpr auto fields_of(const StageTime*) { return fields<&StageTime::stage, &StageTime::ns>(); }

/// Questions of one kind.
struct AskedKind {
  std::string kind;
  std::uint64_t answered = 0;
  std::vector<DurationStep> durations{};  // per message of many questions
};
constexpr auto fields_of(const AskedKind*) {
  return fields<&AskedKind::kind, &AskedKind::answered, &AskedKind::durations>();
}

struct PublisherClock {
  std::string publisher;
  std::int64_t behind_ns = 0;  // how far it lags behind the server's
};
constexpr auto fields_of(const PublisherClock*) {
  return fields<&PublisherClock::publisher, &PublisherClock::behind_ns>();
}

/// The part of a tiled scene file that the server holds.
struct HeldTiles {
  std::string scene;
  std::uint64_t read = 0;       // tiles
  std::uint64_t of = 0;         // tiles of its file
  std::uint64_t triangles = 0;  // held
  std::uint64_t triangles_of_file = 0;
};
constexpr auto fields_of(const HeldTiles*) {
  using T = HeldTiles;
  return fields<&T::scene, &T::read, &T::of, &T::triangles, &T::triangles_of_file>();
}

// Counts since the server's start. In the server, Count is a type that any thread may read.

template <class Count = std::uint64_t>
struct PairCounts {
  Count moved{};       // objects, each counted once per step
  Count candidates{};  // pairs of movers
  Count filtered{};    // pairs of nearby movers excluded by their layers, masks or groups
  Count exact_tests{};
  Count undecided{};
  Count in_doubt{};  // pairs after the newest step
  Count swept{};
  Count kept_apart{};
};
template <class Count>
constexpr auto fields_of(const PairCounts<Count>*) {
  using T = PairCounts<Count>;
  return fields<&T::moved, &T::candidates, &T::filtered, &T::exact_tests, &T::undecided, &T::in_doubt, &T::swept,
                &T::kept_apart>();
}

/// Counts of fences, bands of margins, and questions for the nearest.
template <class Count = std::uint64_t>
struct FenceCounts {
  Count count{};    // after the newest step, as are the next two
  Count entered{};  // fences with an object inside
  Count inside{};   // objects, counted once for each fence that they are in
  Count events{};
  Count cut_short{};  // searches cut short at the evaluation limit
};
template <class Count>
constexpr auto fields_of(const FenceCounts<Count>*) {
  using T = FenceCounts<Count>;
  return fields<&T::count, &T::entered, &T::inside, &T::events, &T::cut_short>();
}

/// Poses that were applied, and those that were received without effect.
template <class Count = std::uint64_t>
struct PoseCounts {
  Count applied{};
  Count late{};
  Count unknown{};
  Count refused{};
  Count superseded{};
  Count dropped{};

  Count lost() const { return unknown + refused + superseded + dropped; }
};
template <class Count>
constexpr auto fields_of(const PoseCounts<Count>*) {
  using T = PoseCounts<Count>;
  return fields<&T::applied, &T::late, &T::unknown, &T::refused, &T::superseded, &T::dropped>();
}

/// Batches whose time stamps were corrected.
template <class Count = std::uint64_t>
struct StampCounts {
  Count late{};  // before that of an earlier batch of the publisher
  Count jumped{};
  Count missing{};
};
template <class Count>
constexpr auto fields_of(const StampCounts<Count>*) {
  using T = StampCounts<Count>;
  return fields<&T::late, &T::jumped, &T::missing>();
}

/// The answer of `figures`. The difference of two answers gives rates and quantiles.
struct Figures {
  std::int64_t up_ns = 0;
  bool keeps_nothing = false;  // the server has no folder for its journal
  std::uint64_t version = 0;
  std::int64_t step_period_ns = 0;  // 0: a step whenever poses arrive
  std::uint64_t steps = 0;
  std::uint64_t stalled_steps = 0;  // retries of steps because readers held every free state
  std::vector<DurationStep> step_durations{};
  std::vector<StageTime> stages{};
  PairCounts<> pairs{};
  FenceCounts<> fences{};
  PoseCounts<> poses{};
  StampCounts<> stamps{};
  std::vector<PublisherClock> clocks{};
  std::vector<AskedKind> questions{};
  std::uint64_t refused = 0;          // requests
  std::uint64_t undecided = 0;        // answers
  std::uint64_t filters_dropped = 0;  // evaluated name patterns evicted from the cache
  std::vector<std::string> not_built{};
  std::vector<HeldTiles> tiles{};
  std::vector<Wing> wings{};
};
constexpr auto fields_of(const Figures*) {
  using T = Figures;
  return fields<&T::up_ns, &T::keeps_nothing, &T::version, &T::step_period_ns, &T::steps, &T::stalled_steps,
                &T::step_durations, &T::stages, &T::pairs, &T::fences, &T::poses, &T::stamps, &T::clocks, &T::questions,
                &T::refused, &T::undecided, &T::filters_dropped, &T::not_built, &T::tiles, &T::wings>();
}

/// One step of the world. Each stage is timed by its own clock readings; whole_ns is measured separately.
struct StepTrace {
  std::uint64_t version = 0;
  std::int64_t world_time_ns = 0;
  std::int64_t take_ns = 0;  // samples and jobs since the previous step
  std::int64_t update_ns = 0;
  std::int64_t index_ns = 0;
  std::int64_t test_ns = 0;
  std::int64_t events_ns = 0;
  std::int64_t publish_ns = 0;
  std::int64_t whole_ns = 0;  // from the first sample that it waited for to its last write, without waiting
  std::uint32_t moved = 0;
  std::uint32_t candidates = 0;  // pairs
  std::uint32_t exact_tests = 0;
  std::uint32_t contacts = 0;
  std::uint32_t events = 0;
};
/// In the order of `collide top --steps --json`.
constexpr auto fields_of(const StepTrace*) {
  using T = StepTrace;
  return fields<&T::version, &T::world_time_ns, &T::take_ns, &T::update_ns, &T::index_ns, &T::test_ns, &T::events_ns,
                &T::publish_ns, &T::whole_ns, &T::moved, &T::candidates, &T::exact_tests, &T::contacts, &T::events>();
}

/// The answer of `steps`: the newest steps, oldest first.
struct NewestSteps {
  std::vector<StepTrace> steps;
};
constexpr auto fields_of(const NewestSteps*) { return fields<&NewestSteps::steps>(); }

}  // namespace collided

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collided::view {

/// A class of a histogram of durations: those longer than the class before allows and at most longest_ns.
struct DurationStep {
  std::int64_t longest_ns = 0;
  std::uint64_t count = 0;
};

/// A stage of the server's work and the time it took.
struct Stage {
  std::string name;
  std::uint64_t ns = 0;
};

/// What was asked of one kind.
struct Asked {
  std::string kind;
  std::uint64_t answered = 0;             // number of questions
  std::vector<DurationStep> durations{};  // of messages, each with many questions
};

/// What the server has done since its start or between two times: its answer to the command `figures`.
struct Figures {
  std::int64_t up_ns = 0;
  std::int64_t step_period_ns = 0;  // 0: a step whenever poses come
  std::uint64_t steps = 0;
  std::uint64_t stalled_steps = 0;
  std::vector<DurationStep> step_durations{};
  std::vector<Stage> stages{};
  std::uint64_t in_doubt = 0;  // number of pairs in doubt now
  std::uint64_t candidates = 0;
  std::uint64_t filtered = 0;
  std::uint64_t exact_tests = 0;
  std::uint64_t fences = 0;          // now, with the bands of margins
  std::uint64_t fences_entered = 0;  // of them, those that something is in
  std::uint64_t in_fences = 0;       // objects in them, each once for every fence
  std::uint64_t fence_events = 0;
  std::uint64_t fences_cut_short = 0;  // searches of theirs that ended at their limit
  std::uint64_t refused_requests = 0;
  std::uint64_t undecided_answers = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_late = 0;
  std::uint64_t poses_lost = 0;   // poses of unknown objects, refused, superseded, or dropped
  std::uint64_t stamps_late = 0;  // batches whose time is before an earlier one of their publisher
  std::uint64_t stamps_jumped = 0;
  std::uint64_t stamps_missing = 0;
  std::vector<Asked> questions{};
  std::vector<std::string> not_built{};
};

/// Reads the command's answer; nothing where it is not as the command promises.
std::optional<Figures> parse_figures(std::string_view json);

/// What was done between two readings; up_ns is then the time between them. Where the server was restarted in between,
/// so its up_ns is less, the newer reading as it is.
Figures between(const Figures& older, const Figures& newer);

/// The duration that a fraction `part` of them (0.5: the median) does not exceed, at most an eighth too long. Nothing
/// where there are none.
std::optional<std::int64_t> quantile_ns(std::span<const DurationStep> durations, double part);

}  // namespace collided::view

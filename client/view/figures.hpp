#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collided::view {

/// So many took longer than the step before says, and at most longest_ns.
struct DurationStep {
  std::int64_t longest_ns = 0;
  std::uint64_t count = 0;
};

struct Stage {
  std::string name;
  std::uint64_t ns = 0;
};

struct Asked {
  std::string kind;
  std::uint64_t answered = 0;             // questions
  std::vector<DurationStep> durations{};  // of the samples that they came in
};

/// What the server has done since its start, or between two moments: its answer to the command `figures`.
struct Figures {
  std::int64_t up_ns = 0;
  std::int64_t step_period_ns = 0;  // 0: on sample
  std::uint64_t steps = 0;
  std::uint64_t stalled_steps = 0;
  std::vector<DurationStep> step_durations{};
  std::vector<Stage> stages{};
  std::uint64_t in_doubt = 0;  // pairs, now
  std::uint64_t candidates = 0;
  std::uint64_t filtered = 0;
  std::uint64_t exact_tests = 0;
  std::uint64_t refused_requests = 0;
  std::uint64_t undecided_answers = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_late = 0;
  std::uint64_t poses_lost = 0;   // of unknown objects, refused, superseded, or dropped
  std::uint64_t stamps_late = 0;  // batches with a time that their publisher had passed
  std::uint64_t stamps_jumped = 0;
  std::uint64_t stamps_missing = 0;
  std::vector<Asked> questions{};
  std::vector<std::string> not_built{};
};

/// Nothing where the text is not what the command promises.
std::optional<Figures> parse_figures(std::string_view json);

/// What was done from the older reading to the newer one; up_ns becomes the time between. Where the server has been
/// started anew meanwhile (it is up for less long), all that the newer one says.
Figures between(const Figures& older, const Figures& newer);

/// The least duration that a share `part` of them (0.5: the median) does not exceed, at most an eighth too long.
/// Nothing where there are none.
std::optional<std::int64_t> quantile_ns(std::span<const DurationStep> durations, double part);

}  // namespace collided::view

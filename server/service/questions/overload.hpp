#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace collided::engine::service {

/// What is left out while more comes than can be done. Superseded poses go first, always and unasked (Inbox); where that
/// is not enough, details: contacts told anew while they go on, and the audit; where that is not enough, questions of the
/// low class are refused. Never left out: removals, what ends, signs of life, commands, an object's newest pose,
/// questions of the high class.
///
/// threads  note() one; the rest any
class Overload {
 public:
  enum class Stage : std::uint8_t { none, details, low_questions };
  static constexpr int kCalmTicks = 10;  // before a stage is taken back

  /// notice  takes a sentence for the log
  explicit Overload(std::function<void(const std::string&)> notice) : notice_(std::move(notice)) {}

  /// Ten times a second. poses: some were superseded since the last time; questions: too many wait, or were turned away.
  void note(bool poses, bool questions);

  bool leaves_out_details() const { return stage() >= Stage::details; }
  bool refuses_low_questions() const { return stage() >= Stage::low_questions; }
  Stage stage() const { return stage_.load(std::memory_order_relaxed); }

 private:
  std::function<void(const std::string&)> notice_;
  std::atomic<Stage> stage_{Stage::none};
  int calm_ticks_ = 0;
};

}  // namespace collided::engine::service

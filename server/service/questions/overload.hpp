#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace collided::engine::service {

/// Decides what is left out while more comes in than the server can process. The inbox merges superseded poses first,
/// always and on its own. If that is not enough, details are left out: ongoing contacts are not reported again, and
/// answers are not audited. Then questions of low importance are refused. Never left out: removals, ends of contacts,
/// signs of life, commands, an object's newest pose, questions of high importance.
///
/// threads  note() one; the rest any
class Overload {
 public:
  enum class Stage : std::uint8_t { none, details, low_questions };
  static constexpr int kCalmTicks = 10;  // calls of note() without pressure before a stage is taken back

  /// notice  takes a sentence for the log
  explicit Overload(std::function<void(const std::string&)> notice) : notice_(std::move(notice)) {}

  /// Call this ten times a second.
  ///
  /// poses      some were superseded since the last call
  /// questions  too many wait, or some were refused
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

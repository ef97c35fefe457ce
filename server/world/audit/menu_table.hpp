#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/world/audit/menu.hpp"

namespace collided::engine {

/// A method of answering.
struct MenuMethod {
  std::string name;
  Level highest = Level::rational;
  double error_m = 0;
  bool boxes = false;
};

/// The rows of one kind of question, one per method, and their times.
class MenuTable {
 public:
  MenuTable(std::string_view asked_of, std::vector<MenuMethod> methods)
      : methods_(std::move(methods)), times_ns_(methods_.size()) {
    for (const MenuMethod& method : methods_)
      rows_.push_back({.asked_of = std::string(asked_of), .method = method.name});
  }
  const std::vector<MenuMethod>& methods() const { return methods_; }
  MenuRow& row(std::size_t method) { return rows_[method]; }

  template <class Work>
  void timed(std::size_t method, const Work& work) {
    ++rows_[method].asked;
    const auto start = std::chrono::steady_clock::now();
    work();
    times_ns_[method].push_back((std::chrono::steady_clock::now() - start).count());
  }
  /// Appends the rows with at least one question.
  void finish(std::vector<MenuRow>& menu);

 private:
  std::vector<MenuMethod> methods_;
  std::vector<std::vector<std::int64_t>> times_ns_;
  std::vector<MenuRow> rows_;
};

/// Time left for judging one kind of question, by the rationals or by FCL.
class JudgingTime {
 public:
  explicit JudgingTime(std::int64_t allowed_ns) : left_ns_(allowed_ns) {}
  /// The first is always judged.
  bool is_left() const { return is_first_ || left_ns_ > 0; }
  template <class Work>
  void spend(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    left_ns_ -= (std::chrono::steady_clock::now() - start).count();
    is_first_ = false;
  }

 private:
  std::int64_t left_ns_;
  bool is_first_ = true;
};

// The rows that menu_of() puts together, each kind in a file of its own.

void add_sweep_rows(const Snapshot& snapshot, const MenuOptions& options, std::vector<MenuRow>& menu);
void add_pair_rows(const Snapshot& snapshot, const MenuOptions& options, std::vector<MenuRow>& menu);

}  // namespace collided::engine

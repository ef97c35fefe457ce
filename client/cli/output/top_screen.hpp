#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/output/top_page.hpp"

namespace collided::cli {

/// Values of earlier looks: the rates of each row of the screen, newest last, and how far each publisher was.
class TopHistory {
 public:
  /// Adds a look; rates of publishers are since the one before.
  void add(const Look& look);
  /// Call this after a restart of the server: earlier values cannot be compared.
  void clear();

  /// By the name of a row ("ray", "step", "poses"), newest last.
  const std::map<std::string, std::deque<double>, std::less<>>& rates() const { return rates_; }
  /// Messages a second of a publisher; nothing before its second look.
  std::optional<double> messages_per_second(std::string_view publisher) const;

 private:
  static constexpr std::size_t kMostKept = 240;
  void append(const std::string& row, double rate);

  std::map<std::string, std::deque<double>, std::less<>> rates_;
  std::map<std::string, std::uint64_t, std::less<>> sequences_;
  std::map<std::string, double, std::less<>> messages_;
};

enum class TopOrder { age, rate, name };

/// The reader's choices for the list of publishers.
struct TopChoice {
  TopOrder order = TopOrder::age;
  bool is_reversed = false;
  std::string filter = {};  // a glob, or a part of the name; empty: all
  bool is_typing = false;   // the filter is being typed
  bool is_paused = false;
};

/// The screen of `collide top`: `rows` lines, each of at most `columns` columns, the keys in the last one; with 0 rows
/// as many lines as needed, without the keys. note: a text above the rest; empty: none.
std::vector<std::string> top_screen(const Look& look, const TopHistory& history, const TopChoice& choice,
                                    std::string_view note, std::size_t columns, std::size_t rows);

/// Values as a curve in braille, two of them a character and four levels high, the newest at the right. Values may be
/// fewer than there is room for.
std::string braille_curve(const std::deque<double>& values, std::size_t columns);

/// The text's first columns, cut between words if that leaves more than half of it: part of a number would read as
/// another one.
std::string cut_between_words(std::string_view line, std::size_t columns);

}  // namespace collided::cli

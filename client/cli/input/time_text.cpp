#include "client/cli/input/time_text.hpp"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

/// Reads a text piece by piece from its beginning. After a missing piece, all later ones are missing too.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  /// A number of exactly `count` digits and at most `most`.
  int digits(std::size_t count, int most) {
    int value = 0;
    const bool are_digits = rest_.size() >= count && rest_.find_first_not_of("0123456789") >= count;
    if (are_digits) std::from_chars(rest_.data(), rest_.data() + count, value);
    skip(are_digits && value <= most, count);
    return value;
  }
  void expect(char wanted) { skip(!rest_.empty() && rest_.front() == wanted, 1); }
  bool has(char wanted) const { return !rest_.empty() && rest_.front() == wanted; }
  /// A fraction such as ".5", of at most nine digits; 0 if there is none.
  nanoseconds fraction() {
    if (!has('.')) return nanoseconds(0);
    rest_.remove_prefix(1);
    const std::size_t count = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    std::int64_t value = 0;
    const bool fits = count >= 1 && count <= 9;
    if (fits) std::from_chars(rest_.data(), rest_.data() + count, value);
    skip(fits, count);
    for (std::size_t i = count; i < 9; ++i) value *= 10;
    return nanoseconds(value);
  }
  bool is_good() const { return is_good_; }
  bool is_at_end() const { return is_good_ && rest_.empty(); }

 private:
  void skip(bool is_there, std::size_t count) {
    is_good_ = is_good_ && is_there;
    rest_.remove_prefix(is_good_ ? count : rest_.size());
  }
  std::string_view rest_;
  bool is_good_ = true;
};

std::optional<nanoseconds> calendar_time(std::string_view text) {
  Reader reader(text);
  const int year = reader.digits(4, 2200);
  reader.expect('-');
  const int month = reader.digits(2, 12);
  reader.expect('-');
  const int day = reader.digits(2, 31);
  reader.expect('T');
  const int hour = reader.digits(2, 23);
  reader.expect(':');
  const int minute = reader.digits(2, 59);
  reader.expect(':');
  const int second = reader.digits(2, 59);
  nanoseconds time = std::chrono::hours(hour) + std::chrono::minutes(minute) + seconds(second) + reader.fraction();
  if (reader.has('+') || reader.has('-')) {
    const bool is_east = reader.has('+');
    reader.expect(is_east ? '+' : '-');
    const int hours_off = reader.digits(2, 23);
    reader.expect(':');
    const nanoseconds off = std::chrono::hours(hours_off) + std::chrono::minutes(reader.digits(2, 59));
    time += is_east ? -off : off;
  } else {
    reader.expect('Z');
  }
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!reader.is_at_end() || !date.ok() || year < 1970) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch() + time;
}

/// Seconds since 1970, read exactly: a double cannot hold today's time to the nanosecond.
std::optional<nanoseconds> seconds_since_1970(std::string_view text) {
  constexpr std::int64_t kMost = 7'000'000'000;  // in the year 2191; nanoseconds end in 2262
  std::int64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error != std::errc{} || whole < 0 || whole > kMost) return std::nullopt;
  Reader reader(text.substr(static_cast<std::size_t>(end - text.data())));
  const nanoseconds fraction = reader.fraction();
  if (!reader.is_at_end()) return std::nullopt;
  return seconds(whole) + fraction;
}

}  // namespace

RunTime parse_time(std::string_view option, std::string_view text, std::string_view may_be) {
  if (text.starts_with('+')) return {RunTime::Since::begin, parse_duration(text.substr(1))};
  if (text.starts_with('-')) return {RunTime::Since::end, -parse_duration(text.substr(1))};
  std::optional<nanoseconds> time = calendar_time(text);
  if (!time) time = seconds_since_1970(text);
  if (!time) throw bad_use(fmt::format("{} '{}' is no time", option, text), std::string(may_be));
  return {RunTime::Since::year_1970, *time};
}

}  // namespace collided::cli

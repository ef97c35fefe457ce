#include "server/intake/readers/text_cursor.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace collided::engine {
namespace {

// Whether a number out of the range of double is too small, so that it counts as 0, and not too large. from_chars
// reports both as "out of range". The sign of the decimal exponent of the first significant digit decides.
bool is_tiny(std::string_view digits) {
  const std::size_t exponent_at = std::min(digits.find_first_of("eE"), digits.size());
  const std::string_view mantissa = digits.substr(0, exponent_at);
  const auto point = static_cast<std::int64_t>(std::min(mantissa.find('.'), mantissa.size()));
  const auto first = static_cast<std::int64_t>(std::min(mantissa.find_first_of("123456789"), mantissa.size()));
  const bool is_negative = digits.substr(exponent_at).find('-') != std::string_view::npos;
  std::int64_t exponent = 0;
  if (exponent_at + 2 < digits.size()) {
    const char* begin = digits.data() + exponent_at + (digits[exponent_at + 1] == '+' ? 2 : 1);
    if (std::from_chars(begin, digits.data() + digits.size(), exponent).ec == std::errc::result_out_of_range) {
      return is_negative;
    }
  }
  return exponent < first - point;
}

}  // namespace

bool TextCursor::is_continuation() const {
  if (!continued_ || *at_ != '\\') { return false; }
  const char* next = at_ + 1;
  if (next != end_ && *next == '\r') { ++next; }
  return next != end_ && *next == '\n';
}

void TextCursor::skip_blanks() {
  while (at_ != end_) {
    if (is_blank(*at_)) {
      ++at_;
    } else if (is_continuation()) {
      ++lines_passed_;
      at_ = static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_))) + 1;
    } else {
      return;
    }
  }
}

void TextCursor::next_line() {
  while (at_ != end_) {
    const void* newline = std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
    const char* line_begin = at_;
    at_ = newline == nullptr ? end_ : static_cast<const char*>(newline) + 1;
    ++lines_passed_;
    if (!continued_ || newline == nullptr) { return; }
    const char* last = at_ - 1;
    if (last != line_begin && last[-1] == '\r') { --last; }
    if (last == line_begin || last[-1] != '\\') { return; }
  }
}

bool TextCursor::find_word() {
  while (at_ != end_ && at_line_end()) { next_line(); }
  return at_ != end_;
}

std::string_view TextCursor::word() {
  if (at_line_end()) { return {}; }
  const char* begin = at_;
  while (!at_blank_or_end()) { ++at_; }
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

std::string_view TextCursor::rest_of_line() {
  skip_blanks();
  const char* begin = at_;
  const void* newline = std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
  at_ = newline == nullptr ? end_ : static_cast<const char*>(newline);
  const char* last = at_;
  while (last != begin && is_blank(last[-1])) { --last; }
  return {begin, static_cast<std::size_t>(last - begin)};
}

double TextCursor::finite_number(std::string_view what) {
  if (at_line_end()) { complain(fmt::format("{} is missing", what)); }
  const char* begin = at_;
  const char* digits = *begin == '+' && end_ - begin > 1 && begin[1] != '-' ? begin + 1 : begin;
  double value = 0;
  const auto [stop, error] = std::from_chars(digits, end_, value);
  if (error == std::errc::invalid_argument) { complain(fmt::format("{} {} is not a number", what, in_quotes(word()))); }
  at_ = stop;
  if (!at_blank_or_end()) {
    at_ = begin;
    complain(fmt::format("{} {} is not a number", what, in_quotes(word())));
  }
  if (error == std::errc::result_out_of_range) {
    value = is_tiny({digits, static_cast<std::size_t>(stop - digits)}) ? 0 : std::numeric_limits<double>::infinity();
  }
  if (!std::isfinite(value)) {
    at_ = begin;
    const bool is_written_out = *digits != 'n' && *digits != 'N' && *digits != 'i' && *digits != 'I' && *digits != '-';
    complain(fmt::format("{} {} is {}", what, in_quotes(word()),
                         is_written_out ? "too large for a double (limit 1.8e308)" : "not finite"));
  }
  return value;
}

std::int64_t TextCursor::integer(std::string_view what) {
  if (at_line_end()) { complain(fmt::format("{} is missing", what)); }
  const char* begin = at_;
  const std::int64_t value = integer_prefix(what);
  if (!at_blank_or_end()) {
    at_ = begin;
    complain(fmt::format("{} {} is not a whole number", what, in_quotes(word())));
  }
  return value;
}

std::int64_t TextCursor::integer_prefix(std::string_view what) {
  const char* begin = at_;
  if (at_ != end_ && *at_ == '+' && end_ - at_ > 1 && at_[1] != '-') { ++at_; }
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(at_, end_, value);
  if (error != std::errc{}) {
    at_ = begin;
    complain(fmt::format("{} {} is not a whole number of 64 bits", what, in_quotes(word())));
  }
  at_ = stop;
  return value;
}

bool TextCursor::skip(char c) {
  if (at_ == end_ || *at_ != c) { return false; }
  ++at_;
  return true;
}

}  // namespace collided::engine

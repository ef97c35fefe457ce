#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Name patterns, matched in the same way by client and server: * any run of bytes, ? one byte, [a-z] one byte of a
/// set, [!a-z] or [^a-z] one byte outside the set.
namespace collided::wire_contract {
namespace glob_detail {

/// Matches one set "[...]" at pattern[at] against a byte and moves `at` past the set. A '[' without an end is an
/// ordinary byte.
inline bool matches_set(std::string_view pattern, std::size_t& at, char c, bool& is_set) {
  std::size_t i = at + 1;
  const bool negated = i < pattern.size() && (pattern[i] == '!' || pattern[i] == '^');
  if (negated) ++i;
  const std::size_t first = i;
  bool found = false;
  for (; i < pattern.size() && (pattern[i] != ']' || i == first); ++i) {
    if (i + 2 < pattern.size() && pattern[i + 1] == '-' && pattern[i + 2] != ']') {
      found = found || (pattern[i] <= c && c <= pattern[i + 2]);
      i += 2;
    } else {
      found = found || pattern[i] == c;
    }
  }
  is_set = i < pattern.size();
  if (is_set) at = i + 1;
  return found != negated;
}

}  // namespace glob_detail

/// True if the whole text matches the pattern; an empty pattern matches only the empty text.
///
/// Only the last star is remembered: on a mismatch it absorbs one more byte. That suffices, since a later star can
/// absorb all that an earlier one could. The time is at most pattern length times text length.
inline bool glob_matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t star_text = 0;
  while (t < text.size()) {
    bool one = false;
    std::size_t next = p + 1;
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
      continue;
    }
    if (p < pattern.size() && pattern[p] == '[') {
      bool is_set = false;
      next = p;
      one = glob_detail::matches_set(pattern, next, text[t], is_set);
      if (!is_set) {
        next = p + 1;
        one = text[t] == '[';
      }
    } else if (p < pattern.size()) {
      one = pattern[p] == '?' || pattern[p] == text[t];
    }
    if (one) {
      p = next;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// A pattern that matches exactly this text.
inline std::string glob_of(std::string_view text) {
  std::string pattern;
  for (const char c : text) {
    const bool is_special = c == '*' || c == '?' || c == '[';
    pattern += is_special ? std::string{'[', c, ']'} : std::string(1, c);
  }
  return pattern;
}

}  // namespace collided::wire_contract

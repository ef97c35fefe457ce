#pragma once

#include <cstdint>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Walks through the text of a mesh file, word by word and line by line. Errors are LoadErrors that name the line. It
/// never reads outside the text and does not depend on the locale. The reading must outlive it.
class TextCursor {
 public:
  enum class LineEnd { newline, newline_or_comment };

  /// comment_rule  whether '#' at the start of a word ends the line
  /// continued     whether a backslash before a newline joins the lines (OBJ)
  TextCursor(const Reading& reading, std::string_view text, LineEnd comment_rule, bool continued)
      : reading_(&reading),
        at_(text.data()),
        end_(text.data() + text.size()),
        comments_(comment_rule == LineEnd::newline_or_comment),
        continued_(continued) {}

  const char* place() const { return at_; }
  /// Line ends passed so far.
  std::uint32_t lines_passed() const { return lines_passed_; }
  bool at_file_end() const { return at_ == end_; }

  /// Skips blanks and returns whether the line has no further word.
  bool at_line_end() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n' || (comments_ && *at_ == '#');
  }
  /// Goes to the start of the next line.
  void next_line();

  /// Goes to the next word, across line ends and comments. False at the end of the file.
  bool find_word();

  /// The next word of this line, empty at its end.
  std::string_view word();
  /// The rest of this line, without blanks at either end.
  std::string_view rest_of_line();

  /// The next word as a number, else an error. `what` names the number in the error, as in "vertex coordinate".
  double finite_number(std::string_view what);
  std::int64_t integer(std::string_view what);
  /// Stops at the first character that is not a digit (the slashes of OBJ).
  std::int64_t integer_prefix(std::string_view what);
  /// Steps over the character c if it comes next, and returns whether it did.
  bool skip(char c);
  bool at_blank_or_end() const { return at_ == end_ || is_blank(*at_) || *at_ == '\n' || is_continuation(); }

  [[noreturn]] void complain(const std::string& what) const { refuse_line(*reading_, at_, what); }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
  bool is_continuation() const;
  void skip_blanks();

  const Reading* reading_;
  const char* at_;
  const char* end_;
  std::uint32_t lines_passed_ = 0;
  bool comments_;
  bool continued_;
};

}  // namespace collided::engine

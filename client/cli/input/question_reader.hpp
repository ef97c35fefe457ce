#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// Questions of one kind, one a line: NDJSON (the first byte is '{'), or CSV / blanks with or without a header.
/// A bad line is refused with line and column, and reading goes on.
class QuestionReader {
 public:
  QuestionReader(const InputFile& file, QuestionKind kind);

  enum class Found { question, refused, end };
  struct Line {
    RawJson id;  // the caller's, else the number of the record from 0
    std::size_t number = 0;
    std::string refusal;  // "line 4812: 'NaN' in column dz"; empty for a question
  };

  /// The next record: a question is added to `questions`. Waits.
  Found next(Questions& questions, Line& line);
  /// True if next() would not wait.
  bool ready() { return lines_.ready(); }

 private:
  bool take_header(const std::string& text);
  void read_cells(const std::string& text, Questions& questions, RawJson& id);
  void read_json(const std::string& text, Questions& questions, RawJson& id);
  double read_number(const std::string& text, std::string_view column) const;

  LineReader lines_;
  const QuestionForm& form_;
  QuestionKind kind_;
  bool started_ = false;
  bool json_ = false;
  bool has_header_ = false;
  char separator_ = ',';
  std::vector<int> column_of_cell_;  // kIdCell, kIgnoredCell or the column
  std::uint64_t record_count_ = 0;
  std::string text_;
  std::vector<std::string> cells_;
};

}  // namespace collided::cli

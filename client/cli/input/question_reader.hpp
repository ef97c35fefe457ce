#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// Reads questions of one kind from a file, one a line: NDJSON if the first byte is '{', else numbers separated by
/// commas or blanks, with or without a header. A bad line is refused with its line and column, and reading continues.
/// One thread.
class QuestionReader {
 public:
  QuestionReader(const InputFile& file, QuestionKind kind);

  enum class Found { question, refused, end };
  struct Line {
    RawJson id;  // as in the file, else the number of the record from 0
    std::size_t number = 0;
    std::string refusal;  // "line 4812: 'NaN' in column dz"; empty for a question
  };

  /// Reads the next record and, if it is a question, adds it to `questions`. May wait.
  Found next(Questions& questions, Line& line);
  /// Whether next() would not wait.
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

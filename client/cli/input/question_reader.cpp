#include "client/cli/input/question_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/text_row.hpp"

namespace collided::cli {
namespace {

constexpr int kIdCell = -1;

int find_column(const QuestionForm& form, std::string_view name) {
  for (std::size_t column = 0; column < form.columns.size(); ++column) {
    if (form.columns[column].name == name || form.columns[column].other_name == name) return static_cast<int>(column);
  }
  return name == "id" ? kIdCell : -2;
}

std::string column_names(const QuestionForm& form) {
  std::string names = "id";
  for (const QuestionColumn& column : form.columns) names += fmt::format(",{}", column.name);
  return names;
}

/// The id in a cell, as JSON; a number stays a number.
RawJson id_from_text(const std::string& text) {
  RawJson id;
  if (nlohmann::json::accept(text) && !text.empty() &&
      (text.front() == '-' || (text.front() >= '0' && text.front() <= '9'))) {
    id.text = text;
  } else {
    append_json_string(id.text, text);
  }
  return id;
}

}  // namespace

QuestionReader::QuestionReader(const InputFile& file, QuestionKind kind)
    : lines_(file.descriptor()), form_(form_of(kind)), kind_(kind) {}

/// Finds the form, the separator and the header from the first line. True if the line is a header.
bool QuestionReader::take_header(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  json_ = text[first] == '{';
  if (json_) return false;
  separator_ = sniff_separator(text);
  split_cells(text, separator_, cells_);
  has_header_ = !is_number_text(cells_.front());
  if (!has_header_) return false;
  for (const std::string& cell : cells_) {
    const int column = find_column(form_, cell);
    if (column < kIdCell) {
      std::vector<std::string> names{"id"};
      for (const QuestionColumn& known : form_.columns) names.emplace_back(known.name);
      throw bad_use(fmt::format("line {}: no column '{}' in {}{}", lines_.line_number(), printable(cell), form_.plural,
                                did_you_mean(cell, names)),
                    "columns: " + column_names(form_));
    }
    if (std::count(column_of_cell_.begin(), column_of_cell_.end(), column) > 0) {
      throw bad_use(fmt::format("line {}: column '{}' stands twice", lines_.line_number(), cell));
    }
    column_of_cell_.push_back(column);
  }
  return true;
}

double QuestionReader::read_number(const std::string& text, std::string_view column) const {
  try {
    return parse_number(text);
  } catch (const Failure&) { throw bad_use(fmt::format("'{}' in column {}", printable(text), column)); }
}

void QuestionReader::read_cells(const std::string& text, Questions& questions, RawJson& id) {
  split_cells(text, separator_, cells_);
  if (!has_header_) {
    if (cells_.size() < form_.fewest_bare || cells_.size() > form_.most_bare) {
      throw bad_use(
          form_.fewest_bare == form_.most_bare
              ? fmt::format("{} numbers, {} are needed", cells_.size(), form_.fewest_bare)
              : fmt::format("{} numbers, {} or {} are needed", cells_.size(), form_.fewest_bare, form_.most_bare));
    }
  } else if (cells_.size() != column_of_cell_.size()) {
    throw bad_use(fmt::format("{} cells under a header of {}", cells_.size(), column_of_cell_.size()));
  }
  Numbers numbers;
  for (std::size_t at = 0; at < cells_.size(); ++at) {
    const int column = has_header_ ? column_of_cell_[at] : static_cast<int>(at);
    if (column == kIdCell) {
      id = id_from_text(cells_[at]);
    } else if (!cells_[at].empty()) {
      const auto index = static_cast<std::size_t>(column);
      numbers.set(index, read_number(cells_[at], form_.columns[index].name));
    }
  }
  add_question(questions, numbers);
}

void QuestionReader::read_json(const std::string& text, Questions& questions, RawJson& id) {
  nlohmann::json object;
  try {
    object = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) { throw bad_use(fmt::format("column {}: not JSON", error.byte)); }
  if (!object.is_object()) throw bad_use("not a JSON object");
  if (object.contains("id")) id.text = object["id"].dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  Numbers numbers;
  for (const JsonKey& key : form_.keys) {
    if (!object.contains(key.name)) continue;
    const nlohmann::json& value = object[std::string(key.name)];
    const bool right_size = key.count == 1 ? !value.is_array() : value.is_array() && value.size() == key.count;
    if (!right_size) throw bad_use(fmt::format("'{}' must hold {} numbers", key.name, key.count));
    for (std::size_t at = 0; at < key.count; ++at) {
      const nlohmann::json& number = key.count == 1 ? value : value[at];
      if (number.is_string()) numbers.set(key.first + at, read_number(number.get<std::string>(), key.name));
      else if (number.is_number()) numbers.set(key.first + at, number.get<double>());
      else
        throw bad_use(
            fmt::format("{} in '{}'", number.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), key.name));
    }
  }
  add_question(questions, numbers);
}

QuestionReader::Found QuestionReader::next(Questions& questions, Line& line) {
  while (lines_.next(text_)) {
    if (is_blank_line(text_)) continue;
    line.number = lines_.line_number();
    line.refusal.clear();
    if (!started_) {
      started_ = true;
      if (text_.starts_with("\xef\xbb\xbf")) text_.erase(0, 3);  // byte order mark
      if (take_header(text_)) continue;
    }
    line.id.text = std::to_string(record_count_++);
    try {
      if (lines_.line_was_cut()) throw bad_use(fmt::format("longer than {} bytes", LineReader::kLongestLine));
      if (json_) read_json(text_, questions, line.id);
      else read_cells(text_, questions, line.id);
      return Found::question;
    } catch (const Failure& failure) {
      line.refusal = fmt::format("line {}: {}", line.number, failure.what());
      return Found::refused;
    }
  }
  return Found::end;
}

}  // namespace collided::cli

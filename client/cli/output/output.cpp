#include "client/cli/output/output.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/suggest.hpp"
#include "client/cli/output/wrapping.hpp"
#include "idl/terminal_text.hpp"

namespace collided::cli {
namespace {

void append_number(std::string& out, double value) {
  std::array<char, 32> text{};
  // Adding 0 turns -0 into 0, which is the same number but a different text.
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value + 0.0);
  out.append(text.data(), result.ptr);
}

void append_json_number(std::string& out, double value) {
  // JSON has no infinity, so it is written as a string, which this project's readers accept.
  if (!std::isfinite(value)) out += '"';
  append_number(out, value);
  if (!std::isfinite(value)) out += '"';
}

void append_json_value(std::string& out, const Value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    out += *flag ? "true" : "false";
  } else if (const auto* number = std::get_if<double>(&value)) {
    append_json_number(out, *number);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out += std::to_string(*whole);
  } else if (const auto* count = std::get_if<std::uint64_t>(&value)) {
    out += std::to_string(*count);
  } else if (const auto* view = std::get_if<std::string_view>(&value)) {
    append_json_string(out, *view);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    append_json_string(out, *text);
  } else if (const auto* raw = std::get_if<RawJson>(&value)) {
    out += raw->text;
  } else if (const auto* vector = std::get_if<MaybeVector>(&value)) {
    out += '[';
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) out += ',';
      append_json_number(out, vector->value[axis]);
    }
    out += ']';
  }
}

bool is_absent(const Value& value) {
  const auto* vector = std::get_if<MaybeVector>(&value);
  return std::holds_alternative<std::monostate>(value) || (vector != nullptr && !vector->given);
}

void append_csv_text(std::string& out, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    out += text;
    return;
  }
  out += '"';
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  out += '"';
}

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

/// Appends text for plain output. Control characters are escaped, so that a record stays one line and cannot control a
/// terminal.
void append_plain_text(std::string& out, std::string_view text) {
  for (const char c : text) {
    if (c == '\t') out += "\\t";
    else if (c == '\n') out += "\\n";
    else if (c == '\r') out += "\\r";
    else if (is_control(c)) out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else out += c;
  }
}

void append_text(std::string& out, std::string_view text, bool csv) {
  if (csv) append_csv_text(out, text);
  else append_plain_text(out, text);
}

/// JSON as text for a column: a string without its quotes.
std::string raw_as_text(const RawJson& raw) {
  if (raw.text.empty() || raw.text.front() != '"') return raw.text;
  const auto parsed = nlohmann::json::parse(raw.text, nullptr, false);
  return parsed.is_string() ? parsed.get<std::string>() : raw.text;
}

void append_column_value(std::string& out, const Value& value, char separator) {
  const bool csv = separator == ',';
  if (const auto* vector = std::get_if<MaybeVector>(&value)) {
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0 && (csv || vector->given)) out += csv ? ',' : ' ';
      if (vector->given) append_number(out, vector->value[axis]);
    }
  } else if (const auto* number = std::get_if<double>(&value)) {
    append_number(out, *number);
  } else if (const auto* view = std::get_if<std::string_view>(&value)) {
    append_text(out, *view, csv);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    append_text(out, *text, csv);
  } else if (const auto* raw = std::get_if<RawJson>(&value)) {
    append_text(out, raw_as_text(*raw), csv);
  } else {
    append_json_value(out, value);
  }
}

/// A row of a table as a line with each number after the name of its column.
std::string row_as_line(const std::vector<std::string>& header, const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t column = 0; column < cells.size(); ++column) {
    if (cells[column].empty()) continue;
    if (!line.empty()) line += "  ";
    if (holds_number(cells[column])) {
      for (const char c : header[column]) line += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
      line += ' ';
    }
    line += cells[column];
  }
  return line;
}

/// Appends after the object's "{" or its last field; nothing if the field has no value.
void append_json_field(std::string& out, const Field& field) {
  if (is_absent(field.value)) return;
  if (out.back() != '{') out += ',';
  out += '"';
  out += field.name;
  out += "\":";
  append_json_value(out, field.value);
}

}  // namespace

std::string record_json(const Record& record) {
  std::string text = "{";
  for (const Field& field : record) append_json_field(text, field);
  return text + "}";
}

void append_json_string(std::string& out, std::string_view text) {
  const bool simple =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
  if (simple) {
    out += '"';
    out += text;
    out += '"';
  } else {
    out += nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
}

std::string value_text(const Value& value) {
  std::string text;
  append_column_value(text, value, '\t');
  return text;
}

std::string printable(std::string_view text) {
  std::string safe = wire_contract::terminal_text(text);
  std::ranges::replace_if(safe, is_control, '?');
  return safe;
}

Printer::Printer(std::ostream& out, Format format, std::vector<std::string> fields, Appearance appearance)
    : out_(out), format_(format), fields_(std::move(fields)), appearance_(appearance) {}

void Printer::choose_fields(const Record& record) {
  selected_.clear();
  const std::vector<std::string>& chosen = fields_.empty() && format_ == Format::plain ? usual_fields_ : fields_;
  if (chosen.empty()) {
    selected_.resize(record.size());
    std::iota(selected_.begin(), selected_.end(), std::size_t{0});
    return;
  }
  for (const std::string& wanted : chosen) {
    const auto found =
        std::find_if(record.begin(), record.end(), [&](const Field& field) { return field.name == wanted; });
    if (found == record.end()) {
      std::vector<std::string> names;
      std::string listed;
      for (const Field& field : record) {
        names.emplace_back(field.name);
        listed += (listed.empty() ? "" : ",") + names.back();
      }
      throw bad_use(fmt::format("no field '{}'{}", wanted, did_you_mean(wanted, names)), "fields: " + listed);
    }
    selected_.push_back(static_cast<std::size_t>(found - record.begin()));
  }
}

void Printer::record(const Record& record) {
  if (fields_.size() == 1 && fields_.front() == "help") return list_fields(record);
  // All records of a verb have the same fields, so they are chosen once.
  if (selected_.empty()) choose_fields(record);
  if (format_ == Format::json) json(record);
  else if (format_ == Format::csv) separated(record, ',');
  else separated(record, '\t');
}

void Printer::list_fields(const Record& record) {
  if (std::exchange(lists_fields_, true)) return;
  for (const Field& field : record) out_ << field.name << '\n';
}

void Printer::json(const Record& record) {
  buffer_ = "{";
  for (const std::size_t index : selected_) append_json_field(buffer_, record[index]);
  buffer_ += "}\n";
  out_ << buffer_;
}

void Printer::separated(const Record& record, char separator) {
  buffer_.clear();
  const bool csv = separator == ',';
  if ((csv || appearance_.header) && !std::exchange(header_written_, true)) {
    for (const std::size_t index : selected_) {
      const std::string name(record[index].name);
      if (!buffer_.empty()) buffer_ += separator;
      const bool three = csv && std::holds_alternative<MaybeVector>(record[index].value);
      buffer_ += three ? fmt::format("{0}_x,{0}_y,{0}_z", name) : name;
    }
    buffer_ += '\n';
  }
  bool first = true;
  for (const std::size_t index : selected_) {
    if (!first) buffer_ += separator;
    first = false;
    append_column_value(buffer_, record[index].value, separator);
  }
  buffer_ += '\n';
  out_ << buffer_;
}

void Printer::line(std::string_view text) {
  out_ << wire_contract::terminal_text(wrapped(text, appearance_.width), true) << '\n';
}

void Printer::row(const std::vector<std::string>& header, std::vector<std::string> cells) {
  if (rows_.empty()) rows_.push_back(header);
  rows_.push_back(std::move(cells));
}

void Printer::finish() {
  std::vector<ColumnWidth> widths;
  for (std::size_t at = 0; at < rows_.size(); ++at) {
    const std::vector<std::string>& cells = rows_[at];
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t column = 0; column < cells.size(); ++column) {
      widths[column].columns = std::max(widths[column].columns, columns_of(cells[column]));
      if (at > 0 && holds_number(cells[column])) widths[column].may_shrink = false;
    }
  }
  const std::vector<ColumnWidth> wide = widths;
  std::size_t gap = 2;
  while (gap > 0 && !fit(widths, appearance_.width, gap)) {
    widths = wide;
    --gap;
  }
  for (std::size_t at = 0; at < rows_.size(); ++at) {
    if (gap == 0) {
      if (at > 0) line(row_as_line(rows_[0], rows_[at]));
      continue;
    }
    std::string text;
    for (std::size_t column = 0; column < rows_[at].size(); ++column) {
      const std::string cell = cut_to(rows_[at][column], widths[column].columns);
      text += cell;
      if (column + 1 < rows_[at].size()) text.append(widths[column].columns - columns_of(cell) + gap, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out_ << wire_contract::terminal_text(at == 0 ? paint(Paint::faint, text) : text, true) << '\n';
  }
  rows_.clear();
}

std::string Printer::paint(Paint paint, std::string_view text) const {
  if (!appearance_.color || paint == Paint::plain) return std::string(text);
  constexpr std::array kCodes{"", "\x1b[32m", "\x1b[31m", "\x1b[33m", "\x1b[2m"};
  return fmt::format("{}{}\x1b[0m", kCodes[static_cast<std::size_t>(paint)], text);
}

}  // namespace collided::cli

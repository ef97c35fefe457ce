#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "client/cli/output/readable.hpp"

namespace collided::cli {

/// table: for people. plain: one record a line, fields separated by tabs. csv: the same with commas and a header. json:
/// one object a line.
enum class Format { table, plain, json, csv };

/// JSON text that is written unchanged.
struct RawJson {
  std::string text;
};

/// A vector, or none: in CSV it takes three columns either way.
struct MaybeVector {
  MaybeVector() = default;
  explicit MaybeVector(const Eigen::Vector3d& vector) : value(vector), given(true) {}
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  bool given = false;
};

/// The value of a field; monostate: there is none.
using Value = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string_view, std::string,
                           MaybeVector, RawJson>;

/// A named value of a record.
struct Field {
  std::string_view name;
  Value value;
};

/// One record of output. Every record of a verb has the same fields in the same order.
using Record = std::vector<Field>;

/// Colours by meaning.
enum class Paint { plain, good, bad, doubt, faint };

/// How output for people looks.
struct Appearance {
  bool color = false;
  Digits digits = Digits::rounded;
  std::size_t width = 0;  // columns of the terminal; 0: lines are not wrapped
  bool header = false;    // print the names of the columns above plain output too
};

/// Writes a verb's output in the chosen form: records for machines, or lines and tables for people. In records, numbers
/// are the shortest text that reads back as the same double; infinity is "inf". One thread.
class Printer {
 public:
  Printer(std::ostream& out, Format format, std::vector<std::string> fields, Appearance appearance);

  /// True if the output is a table and the user chose no fields: then use line() and row(), else record().
  bool human() const { return format_ == Format::table && fields_.empty(); }
  Format format() const { return format_; }
  Digits digits() const { return appearance_.digits; }

  /// Sets the fields of plain output without --fields; csv and json have all fields.
  void set_usual_fields(std::vector<std::string> fields) { usual_fields_ = std::move(fields); }

  /// Writes a record. Throws Failure if --fields has a name that the record lacks. `--fields help` lists the names
  /// instead.
  void record(const Record& record);
  /// Writes a line for people. If it is wider than the terminal it continues on the next one, broken at double blanks.
  void line(std::string_view text);
  /// Adds a row to the table with this header; finish() writes the table.
  void row(const std::vector<std::string>& header, std::vector<std::string> cells);
  /// Writes the table with its columns aligned. If it is wider than the terminal the widest names are cut, never
  /// numbers; if that is not enough, each row becomes a line that names its numbers. The caller flushes records and
  /// lines.
  void finish();

  /// The text with the codes of a colour, if output is coloured.
  std::string paint(Paint paint, std::string_view text) const;

 private:
  void choose_fields(const Record& record);
  void list_fields(const Record& record);
  void json(const Record& record);
  void separated(const Record& record, char separator);

  std::ostream& out_;
  Format format_;
  std::vector<std::string> fields_;
  Appearance appearance_;
  std::vector<std::string> usual_fields_;
  bool lists_fields_ = false;
  bool header_written_ = false;
  std::vector<std::size_t> selected_;
  std::vector<std::vector<std::string>> rows_;
  std::string buffer_;
};

/// A name that is safe to print on a terminal: control characters become '?'.
std::string printable(std::string_view text);

/// A value as one cell of plain output.
std::string value_text(const Value& value);

/// A record as a JSON object with all of its non-empty fields, as `--json` writes it.
std::string record_json(const Record& record);

/// Appends a JSON string with its quotes; bytes that are not UTF-8 become U+FFFD.
void append_json_string(std::string& out, std::string_view text);

}  // namespace collided::cli

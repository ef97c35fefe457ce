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

/// table: for people; plain: one record a line, fields apart by tabs; csv: with a header; json: one object a line.
enum class Format { table, plain, json, csv };

/// JSON text that is written as it stands.
struct RawJson {
  std::string text;
};

/// A vector or its absence: in CSV it takes three columns either way.
struct MaybeVector {
  MaybeVector() = default;
  explicit MaybeVector(const Eigen::Vector3d& vector) : value(vector), given(true) {}
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  bool given = false;
};

using Value = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string_view, std::string,
                           MaybeVector, RawJson>;

struct Field {
  std::string_view name;
  Value value;
};

/// Every record of a verb has the same fields in the same order; what is absent holds monostate.
using Record = std::vector<Field>;

enum class Paint { plain, good, bad, doubt, faint };

/// How text for people looks.
struct Appearance {
  bool color = false;
  Digits digits = Digits::rounded;
  std::size_t width = 0;  // columns of the terminal; 0: lines are not wrapped
  bool header = false;    // names of the columns above plain output too
};

/// Writes records. Numbers are the shortest text that reads back to the same double; infinity is "inf".
class Printer {
 public:
  Printer(std::ostream& out, Format format, std::vector<std::string> fields, Appearance appearance);

  /// True where people read and chose no fields: line() and columns are for them, record() for machines.
  bool human() const { return format_ == Format::table && fields_.empty(); }
  Format format() const { return format_; }
  Digits digits() const { return appearance_.digits; }

  /// The columns of plain output where no --fields were given; the other forms keep all.
  void set_usual_fields(std::vector<std::string> fields) { usual_fields_ = std::move(fields); }

  /// One record; throws Failure when --fields names one that it does not have. `--fields help` lists the names instead.
  void record(const Record& record);
  /// A line as people read it. One that is wider than the terminal goes on below, broken where two blanks are.
  void line(std::string_view text);
  /// A row of the table under a header; flushed by finish() with columns aligned.
  void row(const std::vector<std::string>& header, std::vector<std::string> cells);
  /// Ends a table, its widest columns cut where it is wider than the terminal. Records and lines are flushed by the caller.
  void finish();

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

/// A name as it may stand on a terminal: control characters become '?'.
std::string printable(std::string_view text);

/// A value as one cell of plain output.
std::string value_text(const Value& value);

/// Appends a JSON string with its quotes; bytes that are not UTF-8 become U+FFFD.
void append_json_string(std::string& out, std::string_view text);

}  // namespace collided::cli

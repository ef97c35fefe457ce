#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

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

/// Writes records. Numbers are the shortest text that reads back to the same double; infinity is "inf".
class Printer {
 public:
  Printer(std::ostream& out, Format format, std::vector<std::string> fields, bool color);

  /// True where people read and chose no fields: line() and columns are for them, record() for machines.
  bool human() const { return format_ == Format::table && fields_.empty(); }
  Format format() const { return format_; }

  /// One record; throws Failure when --fields names one that it does not have.
  void record(const Record& record);
  /// A line as people read it.
  void line(std::string_view text);
  /// A row of the table under a header; flushed by finish() with columns aligned.
  void row(const std::vector<std::string>& header, std::vector<std::string> cells);
  /// Ends a table. Records and lines are flushed by the caller.
  void finish();

  std::string paint(Paint paint, std::string_view text) const;

 private:
  void json(const Record& record);
  void separated(const Record& record, char separator);
  void select(const Record& record);

  std::ostream& out_;
  Format format_;
  std::vector<std::string> fields_;
  bool color_;
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

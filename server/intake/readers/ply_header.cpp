#include "server/intake/readers/ply_header.hpp"

#include <fmt/format.h>

#include "server/intake/readers/text_cursor.hpp"

namespace collided::engine {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  struct Name {
    std::string_view old_name;
    std::string_view new_name;
    PlyType type;
  };
  static constexpr Name kNames[] = {
      {"char", "int8", PlyType::int8},        {"uchar", "uint8", PlyType::uint8},
      {"short", "int16", PlyType::int16},     {"ushort", "uint16", PlyType::uint16},
      {"int", "int32", PlyType::int32},       {"uint", "uint32", PlyType::uint32},
      {"float", "float32", PlyType::float32}, {"double", "float64", PlyType::float64},
  };
  for (const Name& entry : kNames) {
    if (name == entry.old_name || name == entry.new_name) { return entry.type; }
  }
  return std::nullopt;
}

bool is_whole_number(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

class HeaderParser {
 public:
  explicit HeaderParser(const Reading& reading)
      : reading_(reading),
        cursor_(reading, {reading.begin(), reading.bytes.size()}, TextCursor::LineEnd::newline, false) {}

  PlyHeader parse() {
    if (cursor_.word() != "ply") { refuse_line(reading_, reading_.begin(), "the first line is not 'ply'"); }
    bool has_format = false;
    for (cursor_.next_line(); cursor_.find_word(); cursor_.next_line()) {
      const std::string_view keyword = cursor_.word();
      if (keyword == "format") {
        parse_format();
        has_format = true;
      } else if (keyword == "element") {
        parse_element();
      } else if (keyword == "property") {
        parse_property();
      } else if (keyword == "end_header") {
        cursor_.rest_of_line();
        header_.body_byte = static_cast<std::size_t>(cursor_.place() - reading_.begin()) + (cursor_.skip('\n') ? 1 : 0);
        if (!has_format) { cursor_.complain("the header has no 'format' line"); }
        check_room();
        return std::move(header_);
      } else if (keyword != "comment" && keyword != "obj_info") {
        skip_stray_line(keyword);
      }
    }
    cursor_.complain("the header has no 'end_header' line");
  }

 private:
  // Skips a line with an unknown keyword: Blender 2.4 wrote its comment without the word. Before the first element such
  // a line cannot describe the rows.
  void skip_stray_line(std::string_view keyword) {
    if (!header_.elements.empty() || reading_.options.strict) {
      cursor_.complain(fmt::format("{} is no word of a PLY header", in_quotes(keyword)));
    }
    reading_.report.mended.push_back(
        fmt::format("1 header line that begins with {} taken for a comment", in_quotes(keyword)));
  }

  void parse_format() {
    const std::string_view name = cursor_.word();
    if (name == "ascii") {
      header_.format = PlyFormat::text;
    } else if (name == "binary_little_endian") {
      header_.format = PlyFormat::little_endian;
    } else if (name == "binary_big_endian") {
      header_.format = PlyFormat::big_endian;
    } else {
      cursor_.complain(
          fmt::format("format {} is not ascii, binary_little_endian or binary_big_endian", in_quotes(name)));
    }
  }

  void parse_element() {
    PlyElement element{.name = cursor_.word(), .properties = {}};
    const std::int64_t count = cursor_.integer("element count");
    if (count < 0) { cursor_.complain(fmt::format("element {} has {} rows", in_quotes(element.name), count)); }
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) {
        cursor_.complain(fmt::format("element {} stands there twice", in_quotes(element.name)));
      }
    }
    element.row_count = static_cast<std::uint64_t>(count);
    header_.elements.push_back(std::move(element));
  }

  void parse_property() {
    if (header_.elements.empty()) { cursor_.complain("property before any element"); }
    PlyProperty property{};
    std::string_view type_name = cursor_.word();
    if (type_name == "list") {
      property.count_type = parse_type(cursor_.word());
      if (!is_whole_number(*property.count_type)) { cursor_.complain("a list is counted in a type of whole numbers"); }
      type_name = cursor_.word();
    }
    property.type = parse_type(type_name);
    property.name = cursor_.word();
    if (property.name.empty()) { cursor_.complain("property without a name"); }
    header_.elements.back().properties.push_back(property);
  }

  PlyType parse_type(std::string_view name) {
    const std::optional<PlyType> type = type_named(name);
    if (!type) { cursor_.complain(fmt::format("{} is no type of PLY", in_quotes(name))); }
    return *type;
  }

  // Refuses more rows than fit the file. A row takes at least the bytes of its numbers and of its lists' lengths, in
  // text a digit and a blank for each.
  void check_room() const {
    const std::uint64_t room = reading_.bytes.size() - header_.body_byte + 1;
    for (const PlyElement& element : header_.elements) {
      std::uint64_t row_bytes = 0;
      for (const PlyProperty& property : element.properties) {
        row_bytes += header_.format == PlyFormat::text ? 2 : byte_count(property.count_type.value_or(property.type));
      }
      if (row_bytes > 0 && element.row_count > room / row_bytes) {
        refuse(reading_, fmt::format("header claims {} rows of element {}, the file has room for {}", element.row_count,
                                     in_quotes(element.name), room / row_bytes));
      }
    }
  }

  const Reading& reading_;
  TextCursor cursor_;
  PlyHeader header_;
};

}  // namespace

std::size_t byte_count(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8: return 1;
    case PlyType::int16:
    case PlyType::uint16: return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32: return 4;
    case PlyType::float64: break;
  }
  return 8;
}

int PlyElement::find(std::string_view property_name) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property_name) { return static_cast<int>(i); }
  }
  return -1;
}

PlyHeader parse_ply_header(const Reading& reading) { return HeaderParser(reading).parse(); }

}  // namespace collided::engine

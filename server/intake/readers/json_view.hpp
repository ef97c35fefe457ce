#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// The whole text as JSON, or a LoadError that names the byte.
nlohmann::json parse_json(const Reading& reading, std::string_view text);

/// A value in a JSON file with the way to it, so that a complaint can say where: "/accessors/3/count is -1, ...".
/// Refers to the document and to the views it came from, which must outlive it; made and dropped while walking down.
class JsonView {
 public:
  JsonView(const Reading& reading, const nlohmann::json& value) : reading_(&reading), value_(&value) {}

  /// False where this is no object.
  bool has(const char* key) const { return value_->contains(key); }
  /// Complains where this is no object or has no such member.
  JsonView at(const char* key) const;
  /// Complains where this is no array or is shorter.
  JsonView at(std::size_t index) const;
  /// An element of the array that a member is: at("nodes").at(i), for numbers that the file gives.
  JsonView element(const char* key, std::size_t index) const;

  bool is_array() const { return value_->is_array(); }
  bool is_object() const { return value_->is_object(); }
  /// Of an array; complains of anything else.
  std::size_t size() const;
  /// How many elements the member has; 0 where there is none.
  std::size_t size_of(const char* key) const { return has(key) ? at(key).size() : 0; }

  double number() const;                         // finite
  std::uint64_t index(std::uint64_t end) const;  // a whole number below end
  std::string text() const;
  std::string text_or(const char* key, std::string otherwise) const { return has(key) ? at(key).text() : otherwise; }
  std::uint64_t index_or(const char* key, std::uint64_t end, std::uint64_t otherwise) const {
    return has(key) ? at(key).index(end) : otherwise;
  }

  const nlohmann::json& json() const { return *value_; }
  /// "/nodes/3/mesh WHAT".
  [[noreturn]] void complain(const std::string& what) const;

 private:
  JsonView(const JsonView& parent, const nlohmann::json& value, const std::string& step)
      : reading_(parent.reading_), value_(&value), motion_(parent.motion_ + '/' + step) {}

  const Reading* reading_;
  const nlohmann::json* value_;
  std::string motion_;
};

}  // namespace collided::engine

#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Parses the whole text as JSON, or throws a LoadError that names the byte.
nlohmann::json parse_json(const Reading& reading, std::string_view text);

/// A value in a JSON file together with its path, so that an error can name its location: "/accessors/3/count is -1,
/// ...". Every function that finds something else than it needs throws a LoadError with that path. A view refers to the
/// document and the reading, which must outlive it.
class JsonView {
 public:
  JsonView(const Reading& reading, const nlohmann::json& value) : reading_(&reading), value_(&value) {}

  /// True if this is an object with that member.
  bool has(const char* key) const { return value_->contains(key); }
  /// A member. Throws if this is not an object or has no such member.
  JsonView at(const char* key) const;
  /// An element. Throws if this is not an array or is shorter.
  JsonView at(std::size_t index) const;
  /// An element of a member that is an array, such as at("nodes").at(i), where the file gives the index.
  JsonView element(const char* key, std::size_t index) const;

  bool is_array() const { return value_->is_array(); }
  bool is_object() const { return value_->is_object(); }
  /// The length of an array. Throws for anything else.
  std::size_t size() const;
  /// The length of an array member; 0 if there is no such member.
  std::size_t size_of(const char* key) const { return has(key) ? at(key).size() : 0; }

  double number() const;                         // finite, else throws
  std::uint64_t index(std::uint64_t end) const;  // a whole number below end, else throws
  std::string text() const;
  std::string text_or(const char* key, std::string otherwise) const { return has(key) ? at(key).text() : otherwise; }
  std::uint64_t index_or(const char* key, std::uint64_t end, std::uint64_t otherwise) const {
    return has(key) ? at(key).index(end) : otherwise;
  }

  const nlohmann::json& json() const { return *value_; }
  /// Throws a LoadError that begins "/nodes/3/mesh WHAT", with this value's path.
  [[noreturn]] void complain(const std::string& what) const;

 private:
  JsonView(const JsonView& parent, const nlohmann::json& value, const std::string& step)
      : reading_(parent.reading_), value_(&value), motion_(parent.motion_ + '/' + step) {}

  const Reading* reading_;
  const nlohmann::json* value_;
  std::string motion_;  // the path from the root: "/nodes/3"
};

}  // namespace collided::engine

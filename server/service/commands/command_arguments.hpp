#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine::service {

/// A command that cannot be carried out: what is wrong, and a hint what to do next where there is one.
struct BadCommand : std::runtime_error {
  explicit BadCommand(const std::string& error, std::string next = {})
      : std::runtime_error(error), hint(std::move(next)) {}
  std::string hint;
};

/// The arguments of a command, each checked when it is read. Every function throws BadCommand where the argument is
/// there but not of the wanted kind; null counts as absent.
class Arguments {
 public:
  /// text  a JSON object with the name of the command under "command"
  explicit Arguments(const std::string& text);

  const std::string& command() const { return command_; }
  /// Whether the client wants it refused where it would not outlive a crash.
  bool is_durable() const { return is_durable_; }
  /// `solid_by` is "winding"; throws BadCommand for another word.
  bool is_solid_by_winding() const;
  /// Refuses every argument that is not among these: a misspelt one must not be ignored.
  void allow_only(std::initializer_list<const char*> names) const;

  /// Whether there is such an argument.
  bool has(const char* name) const;
  /// Three numbers, which may be of any size; nothing where there is no such argument.
  std::optional<Vec3> vector(const char* name) const;
  /// A text; `otherwise` where there is no such argument, here and below.
  std::string text(const char* name, const std::string& otherwise = {}) const;
  /// At most 1,000 texts; empty where there is no such argument.
  std::vector<std::string> texts(const char* name) const;
  bool truth(const char* name, bool otherwise) const;
  /// A finite number.
  double number(const char* name, double otherwise) const;
  /// A whole number from 0 to `most`.
  std::uint64_t whole(const char* name, std::uint64_t otherwise, std::uint64_t most) const;
  /// A list of finite numbers; empty where there is no such argument.
  std::vector<double> numbers(const char* name) const;
  /// [x, y, z, qw, qx, qy, qz], checked as checked_pose() does; nothing where there is no such argument.
  std::optional<Pose> pose(const char* name) const;
  /// [[low 3, high 3], ...], at most 10000 boxes; infinite ends are the texts "inf" and "-inf". Empty where there is no
  /// such argument.
  std::vector<Aabb> boxes(const char* name) const;

 private:
  const nlohmann::json* find(const char* name) const;
  [[noreturn]] void refuse(const char* name, const std::string& allowed) const;

  nlohmann::json arguments_;
  std::string command_;
  bool is_durable_ = false;
};

}  // namespace collided::engine::service

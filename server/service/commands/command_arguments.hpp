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

/// A command that cannot be done: what is wrong, and what to do next where there is something.
struct BadCommand : std::runtime_error {
  explicit BadCommand(const std::string& error, std::string next = {})
      : std::runtime_error(error), hint(std::move(next)) {}
  std::string hint;
};

/// The arguments of a command, each checked when it is asked for. Throws BadCommand.
class Arguments {
 public:
  explicit Arguments(const std::string& text);

  const std::string& command() const { return command_; }
  /// Whatever is not among these is refused: a misspelt argument must not be ignored.
  void allow_only(std::initializer_list<const char*> names) const;

  bool has(const char* name) const;
  std::optional<Vec3> vector(const char* name) const;
  std::string text(const char* name, const std::string& otherwise = {}) const;
  bool truth(const char* name, bool otherwise) const;
  double number(const char* name, double otherwise) const;
  std::uint64_t whole(const char* name, std::uint64_t otherwise, std::uint64_t most) const;
  std::optional<Pose> pose(const char* name) const;
  /// [[low 3, high 3], ...]; infinite ends are the texts "inf" and "-inf". None where there is no such argument.
  std::vector<Aabb> boxes(const char* name) const;

 private:
  const nlohmann::json* find(const char* name) const;
  [[noreturn]] void refuse(const char* name, const std::string& allowed) const;

  nlohmann::json arguments_;
  std::string command_;
};

}  // namespace collided::engine::service

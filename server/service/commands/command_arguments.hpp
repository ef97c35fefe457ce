#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "idl/command_table.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine::service {

/// A command that cannot be carried out: the reason, and a hint what to do next if there is one.
struct BadCommand : std::runtime_error {
  explicit BadCommand(const std::string& error, std::string next = {})
      : std::runtime_error(error), hint(std::move(next)) {}
  std::string hint;
};

/// The arguments of a command, each checked when it is read: by its specification in idl/command_table.hpp, which has
/// the default of an absent one and the largest whole number. Every function throws BadCommand if the argument is
/// present but of the wrong kind; null counts as absent.
class Arguments {
 public:
  /// text  a JSON object with the name of the command under "command"
  explicit Arguments(const std::string& text);
  /// Arguments of the specified command, whatever name the text has.
  Arguments(const std::string& text, const wire_contract::command::CommandSpec& spec);

  const std::string& command() const { return command_; }
  /// null: there is no command of that name.
  const wire_contract::command::CommandSpec* spec() const { return spec_; }
  /// Whether the client wants it refused if it would not survive a crash.
  bool is_durable() const { return is_durable_; }
  /// `solid_by` is "winding"; throws BadCommand for another word.
  bool is_solid_by_winding() const;
  /// Refuses every argument that the command does not have: a misspelt one must not be ignored.
  void refuse_unknown() const;

  /// Whether there is such an argument.
  bool has(const char* name) const;
  /// Three numbers of any size; nothing if there is no such argument.
  std::optional<Vec3> vector(const char* name) const;
  /// A text; `otherwise` if there is no such argument.
  std::string text(const char* name, const std::string& otherwise = {}) const;
  /// At most 1,000 texts; empty if there is no such argument.
  std::vector<std::string> texts(const char* name) const;
  bool truth(const char* name) const;
  /// Nothing if there is no such argument.
  std::optional<bool> truth_if_given(const char* name) const;
  /// A finite number.
  double number(const char* name) const;
  /// A whole number from 0 to the largest of its specification, or to `most` if that is less.
  std::uint64_t whole(const char* name, std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const;
  /// For arguments whose specification allows no more than 32 bits.
  std::uint32_t whole_32(const char* name) const { return static_cast<std::uint32_t>(whole(name)); }
  /// A list of finite numbers; empty if there is no such argument.
  std::vector<double> numbers(const char* name) const;
  /// [x, y, z, qw, qx, qy, qz], checked as checked_pose() does; nothing if there is no such argument.
  std::optional<Pose> pose(const char* name) const;
  /// [[low 3, high 3], ...], at most 10000 boxes; infinite ends are the texts "inf" and "-inf". Empty if there is no
  /// such argument.
  std::vector<Aabb> boxes(const char* name) const;

 private:
  const wire_contract::command::ArgumentSpec* specified(const char* name) const;
  const nlohmann::json* find(const char* name) const;
  const nlohmann::json* find(const char* name, wire_contract::command::ArgumentType type) const;
  [[noreturn]] void refuse(const char* name, const std::string& allowed) const;
  void take_form();

  nlohmann::json arguments_;
  std::string command_;
  const wire_contract::command::CommandSpec* spec_ = nullptr;
  std::span<const wire_contract::command::ArgumentSpec> known_;  // of the text's form
  bool is_durable_ = false;
};

}  // namespace collided::engine::service

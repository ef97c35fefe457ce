#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// The kinds of things that commands add, in the order in which they are repeated.
enum class KeptKind : std::uint8_t {
  cleared,  // a scene of the start options that was removed
  scene,
  gone,  // a member of a scene that was removed
  object,
  member_moved,  // a member of a scene
  moved,
  probe,
  fence,
  rule,        // by its position in their order, two digits
  attached,    // by the name of the child
  succession,  // of the shard map; there is only one
  published    // an object that a lost publisher left, and its pose if a command has moved it
};

/// Names one thing that commands have added.
struct KeptKey {
  KeptKind kind = KeptKind::object;
  std::string name;  // of a member: its scene's, a line feed (which no name contains), and its own
  auto operator<=>(const KeptKey&) const = default;

  static KeptKey of_member(KeptKind kind, const std::string& scene, const std::string& member) {
    return {kind, scene + '\n' + member};
  }
  /// Parses the output of text(); nothing for other text.
  static std::optional<KeptKey> parse(std::string_view text);
  /// "object/crate", as the journal has it.
  std::string text() const;
  /// The scene whose member it names; empty: it does not name a member.
  std::string scene() const;
};

/// The command that adds one thing again.
struct KeptCommand {
  KeptKey key;
  std::string text = {};             // JSON
  std::vector<std::byte> blob = {};  // a Shape of scene.fbs, or empty
  std::uint64_t owner = 0;           // the client or publisher with which it is removed; 0: it outlives both
  bool operator==(const KeptCommand&) const = default;

  std::size_t bytes() const;
};

/// Commands by their keys, ordered by kind and within a kind by when their keys were added.
class KeptCommands {
 public:
  /// Adds a command, or replaces that of its key, which keeps its place.
  void put(KeptCommand command);
  /// Whether there was one of this key.
  bool erase(const KeptKey& key);
  bool contains(const KeptKey& key) const { return numbers_.contains(key); }
  /// The members of a scene among the keys.
  std::vector<KeptKey> members_of(const std::string& scene) const;
  /// Calls visit(command) for each, in the order in which they are repeated.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [place, command] : commands_) visit(command);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  using Place = std::pair<KeptKind, std::uint64_t>;
  std::map<Place, KeptCommand> commands_;
  std::map<KeptKey, std::uint64_t> numbers_;  // the second part of their places
  std::uint64_t put_ = 0;
  std::size_t bytes_ = 0;
};

/// What commands have added to the world, as the commands that make the same world again. Commands put and erase after
/// they have changed the world; the changes of one command go to the sinks together, in the order of the commands.
///
/// threads  the world's
class Inventory {
 public:
  struct Changes {
    std::vector<KeptKey> erased;   // before the others are put
    std::vector<KeptCommand> put;  // in the order in which they are repeated
    std::uint64_t client = 0;      // these two: the command that made the changes; 0: the server itself
    std::uint64_t request = 0;
    bool is_empty() const { return erased.empty() && put.empty(); }
  };
  using Sink = std::function<void(const Changes&)>;

  /// Each sink is called by every flush().
  explicit Inventory(std::vector<Sink> sinks) : sinks_(std::move(sinks)) {}

  /// The scenes that the next process loads by itself: their removal is stored.
  void set_start_scenes(std::set<std::string> scenes) { start_scenes_ = std::move(scenes); }
  const std::set<std::string>& start_scenes() const { return start_scenes_; }
  /// Adds a command of an earlier process. The sinks receive it once it is repeated.
  void restore(KeptCommand command) { kept_.put(std::move(command)); }

  /// Whether a command is new, or repeats one of an earlier process.
  enum class Turn : std::uint8_t { first, again };
  /// Stores a command, replacing that of its key. Entries that it makes obsolete are dropped: moves of a new object,
  /// changes to members of a new scene, and place and attachment of a removed member. A repeated command keeps them,
  /// since they are repeated later.
  void put(const KeptCommand& command, Turn turn = Turn::first);
  /// Drops the command of a key, and entries that depend on it: an object's place and attachment, the members of a
  /// scene. Unknown keys are ignored, except for objects of publishers.
  void erase(const KeptKey& key);
  /// Drops the removed and the moved members of a scene.
  void erase_members(const std::string& scene);
  /// Passes the changes since the last call to the sinks, and returns them.
  ///
  /// client, request  of the command that made them
  Changes flush(std::uint64_t client = 0, std::uint64_t request = 0);

  const KeptCommands& commands() const { return kept_; }

 private:
  void forget(const KeptKey& key);
  void forget_moves_and_attachments(const KeptKey& key);

  const std::vector<Sink> sinks_;
  std::set<std::string> start_scenes_;
  KeptCommands kept_;
  std::vector<KeptKey> erased_;  // since the last flush()
  KeptCommands put_;             // since the last flush()
};

}  // namespace collided::engine::service

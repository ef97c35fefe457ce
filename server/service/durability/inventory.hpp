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

/// The kinds of things that commands bring in, in the order in which they are carried out again.
enum class KeptKind : std::uint8_t {
  cleared,  // a scene of the start options that was removed
  scene,
  gone,  // a member of a scene that was removed
  object,
  member_moved,  // a member of a scene
  moved,
  probe,
  fence,
  rule,        // by its place in their order, two digits
  attached,    // by the name of the child
  succession,  // of the shard map, of which there is one
  published    // an object that a lost publisher left, and where a command has moved it
};

/// Names one thing that commands have brought in.
struct KeptKey {
  KeptKind kind = KeptKind::object;
  std::string name;  // of a member: of its scene, a line feed, which no name has, and its own
  auto operator<=>(const KeptKey&) const = default;

  static KeptKey of_member(KeptKind kind, const std::string& scene, const std::string& member) {
    return {kind, scene + '\n' + member};
  }
  /// Reads what text() writes; nothing for other text.
  static std::optional<KeptKey> parse(std::string_view text);
  /// "object/crate", as the journal has it.
  std::string text() const;
  /// The scene of which it names a member; empty: it names no member.
  std::string scene() const;
};

/// The command that brings one thing in again.
struct KeptCommand {
  KeptKey key;
  std::string text = {};             // JSON
  std::vector<std::byte> blob = {};  // a Shape of scene.fbs, or empty
  std::uint64_t owner = 0;           // the client or publisher that it goes with; 0: it outlives both
  bool operator==(const KeptCommand&) const = default;

  std::size_t bytes() const;
};

/// Commands by their keys, ordered by kind and within a kind by when their keys came.
class KeptCommands {
 public:
  /// Adds a command, or replaces that of its key, which keeps its place.
  void put(KeptCommand command);
  /// Whether there was one of this key.
  bool erase(const KeptKey& key);
  bool contains(const KeptKey& key) const { return numbers_.contains(key); }
  /// The members of a scene among the keys.
  std::vector<KeptKey> members_of(const std::string& scene) const;
  /// Calls visit(command) for each, in the order in which they are carried out again.
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

/// What commands have brought into the world, as the commands that make the same world again. Commands put and erase where
/// they have changed the world; what one of them changed goes to the sinks in one piece, in the order of the commands.
///
/// threads  the world's
class Inventory {
 public:
  struct Changes {
    std::vector<KeptKey> erased;   // before the others are put
    std::vector<KeptCommand> put;  // in the order in which they are carried out again
    std::uint64_t client = 0;      // these two: the command that made them; 0: the server by itself
    std::uint64_t request = 0;
    bool is_empty() const { return erased.empty() && put.empty(); }
  };
  using Sink = std::function<void(const Changes&)>;

  /// Each sink is called by every flush().
  explicit Inventory(std::vector<Sink> sinks) : sinks_(std::move(sinks)) {}

  /// The scenes that the next process loads by itself: the removal of one is kept.
  void set_start_scenes(std::set<std::string> scenes) { start_scenes_ = std::move(scenes); }
  const std::set<std::string>& start_scenes() const { return start_scenes_; }
  /// Adds what an earlier process left. The sinks have it once it is carried out again.
  void restore(KeptCommand command) { kept_.put(std::move(command)); }

  /// Whether a command does something new, or what an earlier process had done.
  enum class Turn : std::uint8_t { first, again };
  /// Keeps a command in place of that of its key. A new object is not moved, a new scene has all of its members, and what
  /// is taken out of a scene has no place and is attached to nothing: what was kept of that goes. If the command is
  /// carried out again, that stays, since its turn is still to come.
  void put(const KeptCommand& command, Turn turn = Turn::first);
  /// Forgets the command of a key, and what depends on it: where an object was and what it was attached to, the members
  /// of a scene. Unknown keys are ignored, but for objects of publishers.
  void erase(const KeptKey& key);
  /// Forgets what was taken out of a scene, and what was moved in it.
  void erase_members(const std::string& scene);
  /// Hands what was changed since the last call to the sinks, and returns it.
  ///
  /// client, request  of the command that changed it
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

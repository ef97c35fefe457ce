#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/recording/opening_commands.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "server/service/recording/flight_fences.hpp"

namespace collided::engine::service {

/// The commands that brought in what is in the world beside publishers' objects: as few as make the same state again,
/// so adding, moving and removing over and over takes no more room.
///
/// limits   kMostBytes, and those of FlightFences; what does not fit is left out and counted
/// threads  one
class FlightCommands {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;
  static constexpr std::size_t kMostUnanswered = 64;
  static constexpr std::size_t kMostNoted = 4'096;
  /// Takes away objects that a lost publisher left: those of a name (nullptr: all), or of them only the moving ones.
  /// True where there was one.
  using TakePublished = std::function<bool(const std::string* name, bool moving_only)>;

  /// Notes a command. It counts once the server has answered that it was done. A command without a client, which the
  /// server carries out by itself after a restart, counts at once.
  void asked(const wire::Query& query);
  /// Notes the answer to a command; other replies are ignored.
  void answered(const wire::Reply& reply, const TakePublished& take);

  /// Calls put(channel, CDR bytes) with each command, oldest first, then those of fences; those without an answer so far come last.
  void write(const std::function<void(recording::Recorded, std::span<const std::byte>)>& put) const;
  std::uint64_t left_out() const { return left_out_ + fences_.left_out(); }
  /// The newest kMostNoted commands of clients that asked() has noted, oldest first.
  std::vector<recording::CommandNumber> noted() const { return {noted_.begin(), noted_.end()}; }

 private:
  struct Kept {
    std::string what;  // name of the command
    std::string name;  // of the object, scene or probe; both globs of a rule
    bool moving = false;
    std::vector<std::byte> bytes;
  };
  struct Unanswered {
    std::uint64_t client = 0, request = 0;
    std::vector<std::byte> bytes;
  };
  void gone(const wire::Reply& reply);
  void done(const std::vector<std::byte>& query, const nlohmann::json& answer, const TakePublished& take);
  void removed(const nlohmann::json& names, const TakePublished& take);
  void cleared(Kept clear, const nlohmann::json& arguments, const TakePublished& take);
  void probed(Kept probe, const nlohmann::json& arguments);
  void ruled(Kept rule, const nlohmann::json& arguments);
  void attached(Kept attachment, nlohmann::json arguments, const nlohmann::json& answer);
  void keep(Kept command);
  /// Forgets the commands of this kind and name; returns how many there were.
  template <class IsChosen>
  std::size_t drop_if(const IsChosen& is_chosen);
  std::size_t drop(std::string_view what, std::string_view name);

  std::vector<Kept> kept_;
  FlightFences fences_;
  std::deque<Unanswered> unanswered_;
  std::deque<recording::CommandNumber> noted_;
  std::size_t bytes_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace collided::engine::service

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/recording/recorded_topics.hpp"

namespace collided::engine::service {

/// The fences, margins and questions for the nearest that stand, as the commands that make them again.
///
/// limits   kMostBytes; those that do not fit are left out and counted
/// threads  one
class FlightFences {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;
  /// So many are written as a command each, of which one that is refused takes no other with it; more of them many in one.
  static constexpr std::size_t kMostSingle = 100;

  /// Takes a command `fence` that was done.
  void done(const wire::Query& query, const nlohmann::json& arguments);
  /// Those that the client had not kept are gone.
  void owner_gone(std::uint64_t client);

  /// Calls put(channel, CDR bytes) with commands that make those again that stand, in the order in which they came. The
  /// client of a command is the owner, which they go with; 0: none.
  void write(const std::function<void(recording::Recorded, std::span<const std::byte>)>& put) const;
  std::uint64_t left_out() const { return left_out_; }

 private:
  enum class Kind : std::uint8_t { fence, margin, nearest };
  struct Standing {
    Kind kind = Kind::fence;
    std::uint64_t owner = 0;   // client that it goes with; 0: it is kept
    std::uint64_t number = 0;  // in the order of their coming
    std::string text;          // arguments, JSON
    std::vector<std::uint8_t> shape;

    std::size_t bytes() const;
  };
  void add(std::uint64_t client, const nlohmann::json& arguments, std::span<const std::byte> shape);
  void remove(const std::string& glob, Kind kind);
  template <class IsChosen>
  void remove_if(const IsChosen& is_chosen);

  std::unordered_map<std::string, Standing> standing_;  // by name
  std::uint64_t added_ = 0;
  std::size_t bytes_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace collided::engine::service

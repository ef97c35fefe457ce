#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "collided/client.hpp"

namespace collided::view {

/// A question about two objects.
struct PairOfNames {
  std::string a;
  std::string b;
};

/// An object, in full.
struct ObjectOfName {
  std::string name;
};

/// The moving objects by publisher.
struct Owners {};

/// The objects nearest to a point.
struct NearestToPoint {
  NearQuestion near;
  std::uint32_t count = 1;  // 1 to kMostNearest
};

/// A ball that moves in a straight line.
struct SweptBall {
  double radius_m = 0;
  SweepQuestion motion;
};

/// The object nearest to another.
struct NearestToObject {
  std::string name;
};

/// The server's memory of its last seconds.
struct Remembered {
  double last_s = 0;  // above 0, at most kMostRemembered_s
};

/// A sample of other clients' questions.
struct SampledSince {
  double since = 0;  // the number of the last one known to the page
};

inline constexpr std::uint32_t kMostNearest = 20;
inline constexpr double kMostRemembered_s = 300;

/// A question of the page, an object of these members beside `ask` and `id`:
/// ray      origin [3], direction [3]
/// sphere   center [3], radius
/// box      center [3], half [3]
/// near     point [3], count
/// sweep    radius, from [3], to [3]
/// pair     a, b
/// object   name
/// nearest  name
/// owners
/// memory   seconds
/// sampled  since
struct PageQuestion {
  double id = 0;  // the page's number for it, repeated in the answer
  std::variant<RayQuestion, SphereQuestion, BoxQuestion, NearestToPoint, SweptBall, PairOfNames, ObjectOfName,
               NearestToObject, Owners, Remembered, SampledSince>
      what;
};

/// Reads a question from untrusted text. Nothing if it is not JSON, a member is missing or of another type, a number is
/// not finite, a size is negative, the direction is zero, or a name is empty or longer than 255 bytes.
std::optional<PageQuestion> parse_page_question(std::string_view text);

}  // namespace collided::view

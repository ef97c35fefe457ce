#include "client/library/connection/errors.hpp"

#include <charconv>
#include <utility>

namespace collided::client {

Error bad_input(std::string message, std::string hint) {
  return {ErrorCode::bad_input, std::move(message), std::move(hint)};
}

Error failure_of(const dds::DdsError& failed) {
  if (dynamic_cast<const dds::NotAllowedError*>(&failed) == nullptr) return {ErrorCode::internal, failed.what(), ""};
  return {
      ErrorCode::refused, failed.what(),
      "where the authority is: collide keys add NAME --role ROLE; `collide help roles` has the rights of each role"};
}

std::string words(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  return {digits, end};
}

std::string words(const Vec3& value) { return words(value.x()) + ' ' + words(value.y()) + ' ' + words(value.z()); }

std::string words(std::chrono::nanoseconds time) {
  const auto rounded = [&](double unit_ns, const char* unit) {
    const double tenths = static_cast<double>(time.count()) / unit_ns * 10;
    return words(static_cast<double>(static_cast<long long>(tenths)) / 10) + unit;
  };
  if (time >= std::chrono::seconds(1)) { return rounded(1e9, " s"); }
  return time >= std::chrono::milliseconds(1) ? rounded(1e6, " ms") : rounded(1e3, " us");
}

}  // namespace collided::client

#pragma once

#include <chrono>
#include <string>

#include "collided/client.hpp"
#include "idl/dds.hpp"

/// Errors with place, fault, value, limit and consequence, and numbers as text for them.
namespace collided::client {

/// The consequence of refused arguments.
inline constexpr const char* kNothingSent = "nothing was sent";

Error bad_input(std::string message, std::string hint = kNothingSent);

/// The error for a failure of DDS; `refused` if the keys do not grant the right.
Error failure_of(const dds::DdsError& failed);

/// The shortest digits that read back as the same number: "0.1", "nan", "-inf".
std::string words(double value);
/// "1 2 3".
std::string words(const Vec3& value);
/// "2 s", "350 ms", "12 us".
std::string words(std::chrono::nanoseconds time);

}  // namespace collided::client

#pragma once

#include <string>

namespace collided::report {

/// Processor, cores, compiler.
std::string machine();
/// "2026-01-31 14:05 UTC"
std::string today();

}  // namespace collided::report

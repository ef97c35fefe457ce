#include <unistd.h>

#include <array>
#include <cstdio>
#include <exception>
#include <new>
#include <vector>

#include "server/programs/import/sandbox.hpp"
#include "server/programs/opinion/fcl_pair.hpp"

// collided-opinion
//
// Reads two objects from stdin (opinion_request.hpp) and prints FCL's answer about them in one line. This is a process
// of its own that may do nothing else, with the importer's limits (sandbox.hpp): FCL ends its process if one of its
// assumptions fails, and the server lives on.

namespace {

/// All bytes on stdin, but at most one beyond the limit: that is enough to refuse them.
std::vector<std::byte> read_all() {
  std::vector<std::byte> bytes;
  std::array<std::byte, 65536> piece;
  while (bytes.size() <= collided::engine::kMostOpinionBytes) {
    const ssize_t got = ::read(STDIN_FILENO, piece.data(), piece.size());
    if (got <= 0) break;
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + got);
  }
  return bytes;
}

int answer() {
  const auto request = collided::engine::read_opinion_request(read_all());
  if (const auto* refusal = std::get_if<std::string>(&request)) {
    std::fprintf(stderr, "%s\n", refusal->c_str());
    return 2;
  }
  std::puts(collided::engine::fcl_answer(std::get<collided::engine::OpinionRequest>(request)).c_str());
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

int main() {
  if (const std::string why = collided::engine::enter_sandbox(STDOUT_FILENO); !why.empty()) {
    std::fprintf(stderr, "%s\n", why.c_str());
    return 1;
  }
  try {
    return answer();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "it needs more than %llu MiB of memory\n", collided::engine::sandbox_memory_bytes() >> 20);
  } catch (const std::exception& error) { std::fprintf(stderr, "%s\n", error.what()); }
  return 1;
}

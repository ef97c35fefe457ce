#include "client/cli/files_program.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/sibling_program.hpp"
#include "idl/terminal_text.hpp"

namespace collided::cli {
namespace {

const Sibling kFiles{.name = "collided-files",
                     .variable = "COLLIDED_FILES",
                     .remedy = "it is installed with collide; COLLIDED_FILES may name it"};

/// Everything that can be read from the descriptor.
std::string all_of(int descriptor) {
  std::string text;
  std::array<char, 65'536> chunk{};
  for (;;) {
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

int run_files_program(const Io& io, std::vector<std::string> words) {
  return exit_code_of(kFiles, start_sibling(io, kFiles, {.words = std::move(words)}));
}

std::string files_program_output(const Io& io, std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw Failure(Exit::refused, fmt::format("no pipe: {}", std::strerror(errno)));
  // A file holds output of any size while it is read.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> said(std::tmpfile(), std::fclose);
  const pid_t child =
      start_sibling(io, kFiles, {.words = std::move(words), .out = ends[1], .err = said ? ::fileno(said.get()) : -1});
  ::close(ends[1]);
  const std::string text = all_of(ends[0]);
  ::close(ends[0]);
  const int code = exit_code_of(kFiles, child);
  std::string messages;
  if (said) {
    std::rewind(said.get());
    messages = all_of(::fileno(said.get()));
  }
  constexpr std::string_view kError = "error: ";
  if (code != 0 && messages.starts_with(kError)) {
    messages.erase(0, kError.size());
    messages.erase(std::min(messages.find('\n'), messages.size()));
    throw bad_use(messages);
  }
  io.err << wire_contract::terminal_text(messages);
  if (code != 0) throw bad_use("the file was not read");
  return text;
}

}  // namespace collided::cli

#include "server/service/runtime/out_of_memory.hpp"

#include <cxxabi.h>
#include <pthread.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <typeinfo>

namespace collided::engine::service {
namespace {

std::terminate_handler terminated_before = nullptr;

/// A bad_alloc that no caller could catch: destructors of JSON values allocate.
[[noreturn]] void end_uncaught() noexcept {
  const std::type_info* thrown = abi::__cxa_current_exception_type();
  if (thrown != nullptr && *thrown == typeid(std::bad_alloc)) {
    constexpr std::size_t kLongestName = 16;
    char name[kLongestName] = "unnamed";
    pthread_getname_np(pthread_self(), name, sizeof name);
    char where[kLongestName + sizeof "the 's thread"];
    std::snprintf(where, sizeof where, "the %s's thread", name);
    end_out_of_memory(where);
  }
  terminated_before();
  std::abort();
}

}  // namespace

void end_out_of_memory(const char* where) noexcept {
  const auto piece = [](const char* text) { return iovec{const_cast<char*>(text), std::strlen(text)}; };
  const std::array<iovec, 3> line{
      piece("error: no memory left for "), piece(where),
      piece("; ending, since half a change is none. Started again it recovers as after a crash\n")};
  // If even this cannot be written nothing can be done; the sum keeps the compiler from warning.
  static_cast<void>(writev(STDERR_FILENO, line.data(), static_cast<int>(line.size())) + 1);
  _exit(kOutOfMemoryExit);
}

void report_aborts() noexcept {
  terminated_before = std::set_terminate(end_uncaught);
  struct sigaction action {};
  action.sa_handler = [](int signal) {
    constexpr char kLine[] =
        "error: ended by abort(), which DDS calls where it gets no memory. Started again it recovers as after a "
        "crash\n";
    static_cast<void>(write(STDERR_FILENO, kLine, sizeof kLine - 1) + 1);
    raise(signal);  // this one ends the process
  };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGABRT, &action, nullptr);
}

}  // namespace collided::engine::service

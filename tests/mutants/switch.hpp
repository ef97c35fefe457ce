#pragma once

// What a planted bug asks at run time: am I the one that is on? plant.py puts this file before every source that it changes.
//   COLLIDED_MUTANT=N           the bug that is on, in this process and those that it starts
//   COLLIDED_MUTANTS_REACHED=F  a file of one byte a bug, mapped: 1 where the bug's place was reached, even by a process killed later

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <type_traits>
#include <utility>

namespace collided_mutants {

struct Reached {
  unsigned char* bytes = nullptr;
  long count = 0;

  Reached() {
    const char* path = std::getenv("COLLIDED_MUTANTS_REACHED");
    const int file = path != nullptr ? open(path, O_RDWR | O_CLOEXEC) : -1;
    struct stat status {};
    if (file < 0 || fstat(file, &status) != 0) return;
    void* mapped = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (mapped == MAP_FAILED) return;
    bytes = static_cast<unsigned char*>(mapped);
    count = static_cast<long>(status.st_size);
  }
};

inline const int chosen = std::getenv("COLLIDED_MUTANT") != nullptr ? std::atoi(std::getenv("COLLIDED_MUTANT")) : -1;
inline const Reached reached;

/// Constant expressions are evaluated by the compiler, where no bug is on.
constexpr bool on(int mutant) {
  if (std::is_constant_evaluated()) return false;
  if (mutant < reached.count) reached.bytes[mutant] = 1;
  return chosen == mutant;
}

/// The value, or that of an empty one of its type where the bug is on.
template <typename Value>
constexpr std::decay_t<Value> empty_if(bool is_on, Value&& value) {
  return is_on ? std::decay_t<Value>{} : std::decay_t<Value>(std::forward<Value>(value));
}

}  // namespace collided_mutants

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/fuzz/fuzz_target.hpp"

// fuzz_X            mutates the seeds: COLLIDED_FUZZ_RUNS times (default 20,000) or COLLIDED_FUZZ_SECONDS (default 5)
// fuzz_X --run N    that one run of COLLIDED_SEED again
// fuzz_X FILE...    replays files

namespace collided::fuzz {
namespace {

std::uint64_t seed_in_use = 0;
std::uint64_t run_in_progress = 0;

std::uint64_t number_from_environment(const char* name, std::uint64_t fallback) {
  const char* text = std::getenv(name);
  return text == nullptr ? fallback : std::strtoull(text, nullptr, 10);
}

void say_where() {
  std::fprintf(stderr, "again with: COLLIDED_SEED=%" PRIu64 " and --run %" PRIu64 "\n", seed_in_use, run_in_progress);
}

extern "C" void on_signal(int signal) {
  say_where();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Changes a file in the ways that break parsers: bits, numbers at the limits, words, pieces cut, doubled and moved.
class Mutator {
 public:
  Mutator(const std::vector<std::string>& seeds, std::uint64_t seed, std::uint64_t run)
      : seeds_(seeds), random_(seed * 0x9e3779b97f4a7c15u + run) {}

  std::string make() {
    std::string bytes = seeds_[below(seeds_.size())];
    for (std::size_t i = 1 + below(6); i > 0; --i) { mutate(bytes); }
    return bytes;
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

  void mutate(std::string& bytes) {
    const std::size_t at = below(bytes.size());
    const std::size_t length = below(std::min<std::size_t>(bytes.size() - at, 64) + 1);
    switch (below(9)) {
      case 0:
        if (!bytes.empty()) { bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); }
        break;
      case 1:
        if (!bytes.empty()) { bytes[at] = static_cast<char>(below(256)); }
        break;
      case 2: bytes.erase(at, length); break;
      case 3: bytes.insert(at, bytes.substr(at, length)); break;
      case 4: bytes.resize(at); break;
      case 5: put_number(bytes, at); break;
      case 6: bytes.insert(at, word()); break;
      case 7: replace_digits(bytes, at); break;
      default: {
        const std::string& other = seeds_[below(seeds_.size())];
        const std::size_t from = below(other.size());
        bytes = bytes.substr(0, at) + other.substr(from, below(512));
      }
    }
  }

  void put_number(std::string& bytes, std::size_t at) {
    static constexpr std::uint32_t kNumbers[] = {0,          1,          2,          3,          4,          7,
                                                 0x7f,       0xff,       0x7fff,     0xffff,     0x7fffffff, 0x80000000,
                                                 0xffffffff, 0xfffffffe, 1000000000, 0x7fc00000, 0x7ff00000};
    const std::uint32_t number = kNumbers[below(std::size(kNumbers))];
    const std::size_t width = std::size_t{1} << below(3);
    if (bytes.size() >= 4) {
      std::memcpy(bytes.data() + std::min(at, bytes.size() - 4) / width * width, &number, width);
    }
  }

  std::string word() {
    static const char* const kWords[] = {" nan ",
                                         " inf ",
                                         " 1e309 ",
                                         " 1e-309 ",
                                         " -1 ",
                                         " 0 ",
                                         "\\\n",
                                         "/",
                                         "//",
                                         "\n",
                                         "\r\n",
                                         "#",
                                         "f 1 1 1\n",
                                         "o a\n",
                                         "g\n",
                                         "usemtl",
                                         "vertex ",
                                         "endloop",
                                         "solid ",
                                         "facet ",
                                         "v 1 2 3\n",
                                         " 4294967296 ",
                                         " 999999999999999999999 ",
                                         "property list char double x\n",
                                         "element face 9\n",
                                         "\xff\xfe",
                                         "\xef\xbb\xbf",
                                         "end_header\n",
                                         "OFF",
                                         "BINARY"};
    return kWords[below(std::size(kWords))];
  }

  void replace_digits(std::string& bytes, std::size_t at) {
    const std::size_t first = bytes.find_first_of("0123456789", at);
    if (first != std::string::npos) {
      const std::size_t end = std::min(bytes.find_first_not_of("0123456789", first), bytes.size());
      bytes.replace(first, end - first, std::to_string(random_() >> below(64)));
    }
  }

  const std::vector<std::string>& seeds_;
  std::mt19937_64 random_;
};

void feed(const std::string& bytes) {
  // A block of its exact size: a byte read beyond it is one that the sanitizer sees.
  const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

void run_once(const std::vector<std::string>& seeds, std::uint64_t run) {
  run_in_progress = run;
  feed(Mutator(seeds, seed_in_use, run).make());
}

int mutate_for_a_while() {
  const std::vector<std::string> seeds = fuzz_seeds();
  for (const std::string& seed : seeds) { feed(seed); }
  const std::uint64_t runs = number_from_environment("COLLIDED_FUZZ_RUNS", 20'000);
  const std::chrono::seconds limit(number_from_environment("COLLIDED_FUZZ_SECONDS", 5));
  const auto end = std::chrono::steady_clock::now() + limit;
  std::uint64_t run = 0;
  for (; run < runs && std::chrono::steady_clock::now() < end; ++run) { run_once(seeds, run); }
  std::printf("%" PRIu64 " mutated inputs, seed %" PRIu64 "\n", run, seed_in_use);
  return 0;
}

}  // namespace

void require(bool holds, const char* sentence) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", sentence);
    std::abort();
  }
}

}  // namespace collided::fuzz

// Called by the address sanitizer, where there is one, before it ends the process.
extern "C" void __asan_on_error();
extern "C" void __asan_on_error() { collided::fuzz::say_where(); }

int main(int argument_count, char** arguments) {
  using namespace collided::fuzz;
  std::signal(SIGABRT, on_signal);
  std::signal(SIGSEGV, on_signal);
  seed_in_use = number_from_environment("COLLIDED_SEED", std::random_device{}());
  if (argument_count == 3 && std::strcmp(arguments[1], "--run") == 0) {
    run_once(fuzz_seeds(), std::strtoull(arguments[2], nullptr, 10));
    return 0;
  }
  for (int i = 1; i < argument_count; ++i) {
    std::ifstream file(arguments[i], std::ios::binary);
    feed({std::istreambuf_iterator<char>(file), {}});
  }
  return argument_count > 1 ? 0 : mutate_for_a_while();
}

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// What each fuzz_*.cpp gives: libFuzzer's entry point, and whole files for the mutations to begin with.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
std::vector<std::string> fuzz_seeds();

namespace collided::fuzz {

/// Loads the bytes as a file of that name. A LoadError is a good answer; a scene must keep every promise of
/// scene.hpp, else the process aborts and says which.
void load_or_refuse(const std::string& file, const std::uint8_t* data, std::size_t size);

/// Aborts with the sentence unless it holds.
void require(bool holds, const char* sentence);

}  // namespace collided::fuzz

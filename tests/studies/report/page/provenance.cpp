#include "tests/studies/report/page/provenance.hpp"

#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

#include <fmt/core.h>

namespace collided::report {

std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) model = line.substr(line.find(':') + 2);
  }
  return fmt::format("{}, {} cores, g++ {}", model, std::thread::hardware_concurrency(), __VERSION__);
}

std::string today() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  char text[40];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text;
}

}  // namespace collided::report

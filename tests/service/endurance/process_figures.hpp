#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace collided::testing_support {

/// Resident memory of a process in MiB; 0 where it is gone.
inline double resident_mib(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  }
  return 0;
}

/// Open files and sockets of a process.
inline int open_files(int pid) {
  std::error_code gone;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", gone)) {
    count += entry.exists(gone) || entry.is_symlink(gone) ? 1 : 0;
  }
  return count;
}

}  // namespace collided::testing_support

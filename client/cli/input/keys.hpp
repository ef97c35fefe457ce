#pragma once

#include <optional>

#include <termios.h>

namespace collided::cli {

/// Reads single keys from a terminal as they are pressed. The destructor restores the terminal's mode. A file that is
/// not a terminal gives no keys. One thread.
class Keys {
 public:
  explicit Keys(int file);
  ~Keys();
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// The next key that was pressed; nothing if there is none. Does not wait.
  std::optional<char> next();

 private:
  int file_;
  bool is_terminal_ = false;
  termios before_{};
};

}  // namespace collided::cli

#pragma once

#include <optional>

#include <termios.h>

namespace collided::cli {

/// Keys as they are pressed, while it lives; the terminal is as before afterwards. No keys where the file is no terminal.
class Keys {
 public:
  explicit Keys(int file);
  ~Keys();
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// The next key, without waiting.
  std::optional<char> next();

 private:
  int file_;
  bool is_terminal_ = false;
  termios before_{};
};

}  // namespace collided::cli

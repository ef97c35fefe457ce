#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "client/view/web_server.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// The world as `collide draw` draws it, as SVG, for browsers without WebGL. Drawn while somebody asks for it, on a thread of
/// its own, that rests for as long as a drawing takes.
class Drawer {
 public:
  Drawer(Client& client, bool y_is_up);
  ~Drawer();
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  /// The newest; null before the first is done. Asks for another. Any thread; returns at once.
  Bytes newest();

 private:
  void work();
  Bytes draw() const;

  Client& client_;
  const bool y_is_up_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Bytes newest_;
  bool is_wanted_ = false;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace collided::view

#include "tests/service/network/tap_hub.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace collided::testing_support {
namespace {

[[noreturn]] void missing(const std::string& what) { throw std::runtime_error(what + ": " + std::strerror(errno)); }

void write_line(const char* path, const std::string& text) { std::ofstream(path) << text; }

/// Name, flags and addresses of a device, through any socket.
class Interface {
 public:
  explicit Interface(const std::string& name) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    std::strncpy(request_.ifr_name, name.c_str(), IFNAMSIZ - 1);
  }
  ~Interface() { ::close(socket_); }
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;

  void set_address(unsigned long request, const std::string& text) {
    auto* address = reinterpret_cast<sockaddr_in*>(&request_.ifr_addr);
    *address = {};
    address->sin_family = AF_INET;
    inet_pton(AF_INET, text.c_str(), &address->sin_addr);
    if (::ioctl(socket_, request, &request_) != 0) missing("an address for " + std::string(request_.ifr_name));
  }
  void bring_up() {
    if (::ioctl(socket_, SIOCGIFFLAGS, &request_) != 0) missing("flags of " + std::string(request_.ifr_name));
    request_.ifr_flags = static_cast<short>(request_.ifr_flags | IFF_UP | IFF_RUNNING);
    if (::ioctl(socket_, SIOCSIFFLAGS, &request_) != 0) missing("bringing up " + std::string(request_.ifr_name));
  }

 private:
  int socket_;
  ifreq request_{};
};

}  // namespace

TapDevice::TapDevice(const std::string& name, int host)
    : file_(::open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
  if (file_ < 0) missing("/dev/net/tun");
  ifreq request{};
  std::strncpy(request.ifr_name, name.c_str(), IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (::ioctl(file_, TUNSETIFF, &request) != 0) {
    const int error = errno;
    ::close(file_);
    errno = error;
    missing("a tap device");
  }
  Interface("lo").bring_up();
  Interface device(name);
  device.set_address(SIOCSIFADDR, "10.77.0." + std::to_string(host));
  device.set_address(SIOCSIFNETMASK, "255.255.255.0");
  device.bring_up();
}

TapDevice::~TapDevice() { ::close(file_); }

void enter_own_network() {
  const std::string user = std::to_string(getuid());
  const std::string group = std::to_string(getgid());
  if (::unshare(CLONE_NEWNET) == 0) return;
  // As somebody who is nobody outside. Only a program that has one thread may become that.
  if (::unshare(CLONE_NEWUSER) != 0) missing("a user namespace");
  write_line("/proc/self/setgroups", "deny");
  write_line("/proc/self/uid_map", "0 " + user + " 1");
  write_line("/proc/self/gid_map", "0 " + group + " 1");
  if (::unshare(CLONE_NEWNET) != 0) missing("a network namespace");
}

TapHub::TapHub(std::vector<int> devices, std::uint64_t seed)
    : devices_(std::move(devices)), random_(seed), thread_([this] { run(); }) {}

TapHub::~TapHub() {
  ending_.store(true);
  thread_.join();
}

void TapHub::set(const Weather& weather) {
  loss_.store(weather.loss);
  reorder_.store(weather.reorder);
  is_cut_.store(weather.is_cut);
}

void TapHub::cut(std::size_t a, std::size_t b, bool is_cut) {
  cut_pairs_.at(a * kMost + b).store(is_cut);
  cut_pairs_.at(b * kMost + a).store(is_cut);
}

void TapHub::run() {
  while (!ending_.load()) {
    std::vector<pollfd> files;
    for (const int device : devices_) files.push_back({device, POLLIN, 0});
    ::poll(files.data(), files.size(), held_back_.empty() ? 20 : 1);
    for (std::size_t device = 0; device < devices_.size(); ++device) take(device);
    const Clock::time_point now = Clock::now();
    while (!held_back_.empty() && held_back_.begin()->first <= now) {
      send(held_back_.begin()->second);
      held_back_.erase(held_back_.begin());
    }
  }
}

void TapHub::take(std::size_t from) {
  constexpr std::size_t kLargest = 65'536;
  Frame frame{.to = -1, .bytes = std::vector<std::uint8_t>(kLargest)};
  for (int i = 0; i < 256; ++i) {
    const ssize_t size = ::read(devices_[from], frame.bytes.data(), kLargest);
    if (size <= 0) return;
    frame.bytes.resize(static_cast<std::size_t>(size));
    for (std::size_t to = 0; to < devices_.size(); ++to) {
      if (to == from) continue;
      frame.to = devices_[to];
      const bool is_lost = is_cut_.load() || cut_pairs_[from * kMost + to].load() || chance(loss_.load());
      if (is_lost) {
        ++lost_;
      } else {
        pass_on(frame);
      }
    }
    frame.bytes.resize(kLargest);
  }
}

void TapHub::pass_on(const Frame& frame) {
  if (!chance(reorder_.load())) return send(frame);
  const auto pause = std::chrono::microseconds(random_() % std::chrono::microseconds(kLongest).count());
  held_back_.emplace(Clock::now() + pause, frame);
}

void TapHub::send(const Frame& frame) {
  ++carried_;
  static_cast<void>(::write(frame.to, frame.bytes.data(), frame.bytes.size()) > 0);
}

}  // namespace collided::testing_support

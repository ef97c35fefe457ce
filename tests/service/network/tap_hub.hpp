#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace collided::testing_support {

/// An Ethernet device whose frames a program reads and writes; closed with the object.
class TapDevice {
 public:
  /// Makes it in the calling thread's network namespace and gives it an address of 10.77.0.0/24.
  /// Throws std::runtime_error with what is missing.
  TapDevice(const std::string& name, int host);
  ~TapDevice();
  TapDevice(const TapDevice&) = delete;
  TapDevice& operator=(const TapDevice&) = delete;
  int file() const { return file_; }

 private:
  int file_ = -1;
};

/// Gives the calling thread, and what it starts, a network of its own that reaches nothing, without other rights than a
/// user has where the system allows that. Throws std::runtime_error with what is missing.
void enter_own_network();

/// A hub that joins devices: what one sends, all others get. It loses frames, lets others overtake and can be cut.
class TapHub {
 public:
  struct Weather {
    double loss = 0;      // part of the frames
    double reorder = 0;   // part of them that is held back for up to kLongest
    bool is_cut = false;  // everybody from everybody
  };
  static constexpr std::chrono::milliseconds kLongest{10};
  static constexpr std::size_t kMost = 8;

  /// The devices' files, at most kMost.
  TapHub(std::vector<int> devices, std::uint64_t seed);
  ~TapHub();
  void set(const Weather& weather);
  /// Cuts two devices, by their places, from each other, or joins them again.
  void cut(std::size_t a, std::size_t b, bool is_cut);
  std::uint64_t carried() const { return carried_.load(); }
  std::uint64_t lost() const { return lost_.load(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    int to = -1;
    std::vector<std::uint8_t> bytes;
  };
  void run();
  void take(std::size_t from);
  void pass_on(const Frame& frame);
  void send(const Frame& frame);
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }

  const std::vector<int> devices_;
  std::atomic<double> loss_{0};
  std::atomic<double> reorder_{0};
  std::atomic<bool> is_cut_{false};
  std::array<std::atomic<bool>, kMost * kMost> cut_pairs_{};  // by from * kMost + to
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> carried_{0}, lost_{0};
  std::mt19937_64 random_;
  std::multimap<Clock::time_point, Frame> held_back_;
  std::thread thread_;
};

}  // namespace collided::testing_support

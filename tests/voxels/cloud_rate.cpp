// What live clouds cost: a lidar of 300,000 points a scan moves through a hall at 10 Hz, and its cells are kept in a
// server's world. Prints processor time of this program (the cells) and of the server (the world) a scan, and how old the
// world is when a scan is in it. Where the machine is too slow for 10 Hz, scans come later but are stamped as if not. Usage: cloud_rate DOMAIN [SECONDS [free|undecided|occupied [CELL]]]

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "collided/client.hpp"
#include "collided/voxels.hpp"
#include "tests/oracle/seed.hpp"

namespace {

using namespace collided;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kPoints = 300'000;
constexpr double kRate_hz = 10;

struct Furniture {
  Vec3 low, high;
};

/// Distance to the hall's walls from within, and to what stands there.
double cast(const Vec3& from, const Vec3& along, const std::vector<Furniture>& things) {
  const Vec3 low(-15, -10, 0), high(15, 10, 4);
  double wall_m = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] != 0) wall_m = std::min(wall_m, ((along[axis] > 0 ? high : low)[axis] - from[axis]) / along[axis]);
  }
  for (const Furniture& thing : things) {
    double begin = 0, end = wall_m;
    for (int axis = 0; axis < 3; ++axis) {
      double a = (thing.low[axis] - from[axis]) / along[axis], b = (thing.high[axis] - from[axis]) / along[axis];
      if (a > b) std::swap(a, b);
      begin = std::max(begin, a);
      end = std::min(end, b);
    }
    if (begin < end) wall_m = begin;
  }
  return wall_m;
}

std::vector<float> scan_from(const Vec3& from, const std::vector<Furniture>& things, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<float> points;
  points.reserve(3 * kPoints);
  constexpr int kBeams = 128;
  constexpr int kColumns = static_cast<int>(kPoints) / kBeams + 1;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double up = (-25.0 + 40.0 * static_cast<double>(i % kBeams) / kBeams) * M_PI / 180;
    const double turn = 2 * M_PI * static_cast<double>(i / kBeams) / kColumns + 1e-3;
    const Vec3 along(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
    const Vec3 point = from + (cast(from, along, things) + noise(random)) * along;
    for (const double x : point) points.push_back(static_cast<float>(x));
  }
  return points;
}

double own_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// User and system time of a process, from its line in /proc.
double seconds_of(std::uint32_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  std::getline(file, line);
  std::string rest = line.substr(line.rfind(')') + 2);
  std::vector<std::string> words;
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t end = std::min(rest.find(' ', at), rest.size());
    words.push_back(rest.substr(at, end - at));
    at = end + 1;
  }
  const double ticks = std::stod(words.at(11)) + std::stod(words.at(12));
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

template <class T>
T need(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2) return 2;
  const double seconds = argument_count > 2 ? std::atof(arguments[2]) : 10;
  const std::string unknown = argument_count > 3 ? arguments[3] : "free";
  const double cell_m = argument_count > 4 ? std::atof(arguments[4]) : 0.05;
  std::mt19937_64 random = oracle::seeded(2525);
  std::vector<Furniture> things;
  std::uniform_real_distribution<double> x(-13, 13), y(-9, 9), size(0.2, 1.2);
  for (int i = 0; i < 60; ++i) {
    const Vec3 low(x(random), y(random), 0);
    // None on the way of the sensor.
    if (std::abs(low.y()) < 2) continue;
    things.push_back({low, low + Vec3(size(random), size(random), 2 * size(random))});
  }
  constexpr std::size_t kScans = 40;
  std::vector<std::vector<float>> scans;
  std::vector<Vec3> origins;
  for (std::size_t i = 0; i < kScans; ++i) {
    // To and fro at 1 m/s.
    const double along = i < kScans / 2 ? static_cast<double>(i) : static_cast<double>(kScans - i);
    origins.emplace_back(-1 + along / kRate_hz, 0.1, 1.3);
    scans.push_back(scan_from(origins.back(), things, random));
  }
  Client client = need(Client::connect({.domain = std::atoi(arguments[1])}));
  Publisher publisher = need(client.publish("cloud_rate", {.lease = std::chrono::seconds(60)}));
  const auto choice = unknown == "undecided"  ? UnknownCells::undecided
                      : unknown == "occupied" ? UnknownCells::occupied
                                              : UnknownCells::free;
  PublishedVoxels voxels = need(PublishedVoxels::start(
      publisher, "scan", {.cell_m = cell_m, .unknown = choice, .decay = std::chrono::seconds(10)}));
  Result<ServerStatus> status = client.status();
  for (int tries = 0; !status && tries < 20; ++tries) status = client.status();
  const std::uint32_t pid = need(std::move(status)).pid;
  double insert_s = 0, worst_s = 0, age_s = 0;
  std::size_t frames = 0, late = 0, changed = 0, dropped = 0, silences = 0;
  double own_before = 0, server_before = 0;
  const auto frame_count = static_cast<std::size_t>(seconds * kRate_hz);
  constexpr std::size_t kFirst = 10;  // the hall is new to the grid
  const Clock::time_point start = Clock::now();
  for (; frames < frame_count + kFirst; ++frames) {
    const auto due = start + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(static_cast<double>(frames) / kRate_hz));
    std::this_thread::sleep_until(due);
    if (frames == kFirst) {
      own_before = own_seconds();
      server_before = seconds_of(pid);
      insert_s = worst_s = age_s = 0;
      changed = late = 0;
    }
    const Clock::time_point before = Clock::now();
    const std::size_t number = frames % kScans;
    const std::chrono::nanoseconds time(static_cast<std::int64_t>(1e9 * static_cast<double>(frames) / kRate_hz));
    Result<VoxelScan> inserted = voxels.insert(publisher, std::span<const float>(scans[number]), origins[number], time);
    // What was not sent, for a silent server, the next call sends.
    for (int tries = 0; !inserted && inserted.error().code == ErrorCode::disconnected && tries < 20; ++tries) {
      silences += 1;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      if (const Result<std::size_t> sent = voxels.decay(publisher, time); sent) inserted = VoxelScan{};
    }
    const VoxelScan scan = need(std::move(inserted));
    const double took_s = std::chrono::duration<double>(Clock::now() - before).count();
    // A server that is out of breath is silent for a moment; then its time counts.
    for (int tries = 0;; ++tries) {
      const Result<void> applied = publisher.wait_applied(std::chrono::seconds(5));
      if (applied) break;
      if (applied.error().code != ErrorCode::disconnected || tries == 20) {
        std::fprintf(stderr, "%s\n", applied.error().message.c_str());
        return 1;
      }
      silences += 1;
    }
    const double in_world_s = std::chrono::duration<double>(Clock::now() - before).count();
    insert_s += took_s;
    age_s += in_world_s;
    worst_s = std::max(worst_s, in_world_s);
    late += in_world_s > 1 / kRate_hz ? 1 : 0;
    changed += scan.changed;
    dropped += scan.dropped;
  }
  const auto count = static_cast<double>(frames - kFirst);
  const double own_s = own_seconds() - own_before, server_s = seconds_of(pid) - server_before;
  std::printf("%zu points, %.0f Hz, cells of %g m, unknown is %s\n", kPoints, kRate_hz, cell_m, unknown.c_str());
  std::printf("grid      %zu occupied cells, %zu blocks, %zu objects; %.0f blocks change a scan, %zu points dropped\n",
              voxels.grid().occupied_count(), voxels.grid().block_count(), voxels.object_count(),
              static_cast<double>(changed) / count, dropped);
  std::printf("a scan    %.1f ms to insert, %.1f ms until it is in the world, at worst %.1f ms; %zu of %.0f late\n",
              1e3 * insert_s / count, 1e3 * age_s / count, 1e3 * worst_s, late, count);
  if (silences > 0) std::printf("silent    the server was, %zu times\n", silences);
  std::printf("processor %.1f ms a scan for the cells, %.1f ms for the server; at %.0f Hz %.2f cores together\n",
              1e3 * own_s / count, 1e3 * server_s / count, kRate_hz, kRate_hz * (own_s + server_s) / count);
  return 0;
}

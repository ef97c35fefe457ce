// The n-th write, fsync, rename or malloc fails, n = 1, 1 + STRIDE, ... up to 500, while a journal is kept, a scene file
// saved and loaded, and files are imported; then CORRUPTIONS bits are flipped and ends cut off:
//   failing_calls STRIDE CORRUPTIONS IMPORTER PRELOAD
// Each in a process of its own. Prints a line for each part; exits 1 where one crashed or took what is not what was saved.

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <list>
#include <random>
#include <string>
#include <vector>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/durability/journal.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/preload/failing_calls.hpp"

namespace collided::testing_support {
using namespace engine;
namespace {

using service::Journal;

constexpr long kMostCalls = 500;
constexpr const char* kSceneFile = "scene.cscene";

/// What a process of its own came to.
enum class Outcome : int { fine, not_reached, bad };

struct Tally {
  int runs = 0, failed = 0, crashes = 0, bad = 0;
};

std::string read_all(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void write_all(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

Outcome in_own_process(const std::function<Outcome()>& work, bool& crashed) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) _exit(static_cast<int>(work()));
  int status = 0;
  waitpid(child, &status, 0);
  crashed = !WIFEXITED(status);
  return crashed ? Outcome::bad : static_cast<Outcome>(WEXITSTATUS(status));
}

/// Each call of each kind in turn, until n is more than there are.
Tally fail_each(const char* what, std::initializer_list<Failing> kinds, long stride,
                const std::function<Outcome(Failing, long)>& work) {
  Tally tally;
  for (const Failing kind : kinds) {
    for (long n = 1; n <= kMostCalls; n += stride) {
      bool crashed = false;
      const Outcome outcome = in_own_process([&] { return work(kind, n); }, crashed);
      ++tally.runs;
      tally.crashes += crashed ? 1 : 0;
      tally.bad += outcome == Outcome::bad && !crashed ? 1 : 0;
      tally.failed += outcome == Outcome::not_reached ? 0 : 1;
      if (outcome == Outcome::bad) {
        std::fprintf(stderr, "%s: %s number %ld: %s\n", what, kFailingNames[static_cast<int>(kind)], n,
                     crashed ? "crashed" : "wrong");
      }
      if (outcome == Outcome::not_reached) break;
    }
  }
  std::printf("%s: runs=%d failures=%d crashes=%d bad_loads=%d\n", what, tally.runs, tally.failed, tally.crashes,
              tally.bad);
  return tally;
}

// ---- what is saved

/// A hill with an index, objects with and without one.
Scene make_scene(std::uint64_t seed) {
  Scene scene{.name = "hill", .mesh = scenes::terrain(12, 10, seed), .parts = {{"hill", 0, 288, {}}}};
  for (const char* name : {"ball", "crate"}) scene.objects.push_back({.name = name});
  scene.objects[0].shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, 1));
  scene.objects[1].shape.primitives.emplace_back(Sphere{{0, 0, 0}, 1});
  for (auto* index : {&scene.index, &scene.objects[0].index}) {
    const TriangleMesh& mesh = index == &scene.index ? scene.mesh : *scene.objects[0].shape.mesh;
    const auto bytes = std::make_shared<const std::vector<std::byte>>(Bvh::build(mesh).saved(mesh));
    *index = {*bytes, bytes};
  }
  return scene;
}

bool same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

/// What matters of the scene is as it was saved.
bool same(const Scene& a, const Scene& b) {
  return a.name == b.name && same(a.mesh, b.mesh) && a.parts.size() == b.parts.size() &&
         a.parts[0].name == b.parts[0].name && a.objects.size() == b.objects.size() &&
         a.objects[0].name == b.objects[0].name && a.objects[1].name == b.objects[1].name &&
         same(*a.objects[0].shape.mesh, *b.objects[0].shape.mesh) &&
         std::get<Sphere>(a.objects[1].shape.primitives.at(0)).radius_m ==
             std::get<Sphere>(b.objects[1].shape.primitives.at(0)).radius_m;
}

struct Loaded {
  Scene scene;
  IndexedScene indexed;
  LoadReport report;
};

/// Throws what loading throws.
Loaded load(const std::string& path) {
  Loaded loaded;
  loaded.scene = load_scene(path, {}, loaded.report);
  loaded.indexed = World::index_scene(loaded.scene, {.threads = 2, .progress = {}, .cancelled = {}});
  return loaded;
}

// ---- parts

Outcome keep_journal(const std::string& folder, Failing kind, long n) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto entry = [](int i, int size) {
    return Journal::Entry{.key = "object/" + std::to_string(i),
                          .text = "add",
                          .blob = std::vector<std::byte>(static_cast<std::size_t>(size), std::byte{7})};
  };
  std::vector<std::list<Journal::Entry>> states;
  std::list<Journal::Entry> last;
  bool failed = false;
  try {
    Journal journal(service::disk_in(folder), "it");
    fail_call(kind, n);
    // Large ones, so that it is rewritten on the way.
    for (int i = 0; i < 60; ++i) journal.put(entry(i % 5, 60'000 + i), Journal::Sync::now);
    failed = stop_failing();
    journal.put(entry(9, 1), Journal::Sync::now);
    if (!journal.problem().empty()) return Outcome::bad;
    last = journal.entries();
  } catch (const std::bad_alloc&) {
    failed = stop_failing();
    Journal again(service::disk_in(folder), "it");
    return again.entries().size() <= 5 ? Outcome::fine : Outcome::bad;
  }
  const Journal again(service::disk_in(folder), "it");
  if (again.entries() != last || !again.damage().empty()) return Outcome::bad;
  return failed ? Outcome::fine : Outcome::not_reached;
}

/// The old file or the new one is there in the end, whole.
Outcome save(const std::string& folder, const Scene& before, const Scene& after, Failing kind, long n) {
  const std::string path = folder + "/" + kSceneFile;
  save_scene(path, before);
  bool is_saved = false;
  fail_call(kind, n);
  try {
    save_scene(path, after);
    is_saved = true;
  } catch (const LoadError&) {
  } catch (const std::bad_alloc&) {}
  const bool failed = stop_failing();
  const Scene there = load(path).scene;
  const bool is_right = is_saved ? same(there, after) : same(there, before) || same(there, after);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder)) ++files;
  // What a failed save began is not left lying about, but where there was no memory to name it.
  if (!is_right || (files != 1 && kind != Failing::malloc)) return Outcome::bad;
  return failed ? Outcome::fine : Outcome::not_reached;
}

/// Either the scene comes or a refusal.
Outcome load_from(const std::string& path, const Scene& expected, Failing kind, long n) {
  bool is_right = true;
  fail_call(kind, n);
  try {
    const Loaded loaded = load(path);
    stop_failing();
    is_right = same(loaded.scene, expected);
  } catch (const LoadError&) {
  } catch (const std::bad_alloc&) {}
  const bool failed = stop_failing();
  if (!is_right) return Outcome::bad;
  return failed ? Outcome::fine : Outcome::not_reached;
}

/// The same for formats of text, of which only the triangles are compared.
Outcome import_from(const std::string& path, std::size_t triangles, Failing kind, long n) {
  bool is_right = true;
  fail_call(kind, n);
  try {
    LoadReport report;
    const Scene scene = load_scene(path, {}, report);
    stop_failing();
    is_right = scene.mesh.triangles.size() == triangles;
  } catch (const LoadError&) {
  } catch (const std::bad_alloc&) {}
  const bool failed = stop_failing();
  if (!is_right) return Outcome::bad;
  return failed ? Outcome::fine : Outcome::not_reached;
}

/// The converter's process fails, this one refuses.
Outcome convert_from(const std::string& path, const std::string& importer, const std::string& preload,
                     std::size_t triangles, Failing kind, long n) {
  setenv("COLLIDED_IMPORT", importer.c_str(), 1);
  setenv("LD_PRELOAD", preload.c_str(), 1);
  setenv("COLLIDED_FAIL", (std::string(kFailingNames[static_cast<int>(kind)]) + " " + std::to_string(n)).c_str(), 1);
  try {
    LoadReport report;
    return load_scene(path, {}, report).mesh.triangles.size() == triangles ? Outcome::fine : Outcome::bad;
  } catch (const LoadError&) { return Outcome::fine; }
}

/// A bit of the file flipped, or its end cut off: refused, or told and the content as it was.
struct Corruptions {
  int made = 0, detected = 0, bad_loads = 0;

  /// cuts  sizes to cut to besides those that chance finds
  template <class Detected>
  void make(const char* what, const std::string& path, int count, std::mt19937_64& random,
            const std::vector<std::size_t>& cuts, Detected&& is_detected) {
    const std::string whole = read_all(path);
    for (int i = 0; i < count; ++i) {
      std::string bytes = whole;
      const auto number = static_cast<std::size_t>(i);
      const bool is_cut = i % 4 == 0 || number < cuts.size();
      const std::size_t at = number < cuts.size() ? cuts[number] : random() % whole.size();
      is_cut ? bytes.resize(at) : void(bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8)));
      write_all(path, bytes);
      bool is_bad = false;
      const bool seen = is_detected(is_bad);
      ++made;
      detected += seen ? 1 : 0;
      bad_loads += is_bad ? 1 : 0;
      if (!seen || is_bad)
        std::fprintf(stderr, "%s: %s %zu of %zu: %s\n", what, is_cut ? "cut at" : "bit of byte", at, whole.size(),
                     is_bad ? "a bad load" : "not seen");
    }
    write_all(path, whole);
  }
};

int corrupt(const std::string& folder, const Scene& scene, int count) {
  std::mt19937_64 random = oracle::seeded(77);
  Corruptions corruptions;
  const std::string path = folder + "/" + kSceneFile;
  save_scene(path, scene);
  corruptions.make("scene file", path, count / 2, random, {}, [&](bool& is_bad) {
    try {
      const Loaded loaded = load(path);
      is_bad = !same(loaded.scene, scene);
      return !loaded.report.warnings.empty() || !loaded.indexed.geometry->warnings.empty();
    } catch (const LoadError&) { return true; }
  });
  std::list<Journal::Entry> entries;
  const std::string journal_path = folder + "/it.journal";
  std::vector<std::size_t> between_records;
  {
    Journal journal(service::disk_in(folder), "it.journal");
    for (int i = 0; i < 40; ++i) {
      journal.put({.key = "object/" + std::to_string(i),
                   .text = std::string(random() % 90, 'x'),
                   .blob = std::vector<std::byte>(random() % 200)},
                  Journal::Sync::later);
      between_records.push_back(std::filesystem::file_size(journal_path));
    }
    between_records.pop_back();
    entries = journal.entries();
  }
  corruptions.make("journal", journal_path, count - count / 2, random, between_records, [&](bool& is_bad) {
    const Journal journal(service::disk_in(folder), "it.journal");
    // What it has is what was written first.
    is_bad = journal.entries().size() > entries.size() ||
             !std::equal(journal.entries().begin(), journal.entries().end(), entries.begin());
    return !journal.damage().empty();
  });
  std::printf("corruptions=%d detected=%d bad_loads=%d\n", corruptions.made, corruptions.detected,
              corruptions.bad_loads);
  return corruptions.detected == corruptions.made && corruptions.bad_loads == 0 ? 0 : 1;
}

int run(long stride, int corruption_count, const std::string& importer, const std::string& preload) {
  const ScratchFolder folder;
  const std::string state = folder.path() + "/state";
  const std::string files = folder.path() + "/files";
  std::filesystem::create_directories(files);
  const Scene before = make_scene(1);
  const Scene after = make_scene(2);
  const std::string path = files + "/" + kSceneFile;
  std::vector<Tally> tallies;
  const std::initializer_list<Failing> kAll = {Failing::write, Failing::fsync, Failing::rename, Failing::malloc};
  tallies.push_back(
      fail_each("journal", kAll, stride, [&](Failing kind, long n) { return keep_journal(state, kind, n); }));
  tallies.push_back(
      fail_each("save", kAll, stride, [&](Failing kind, long n) { return save(files, before, after, kind, n); }));
  save_scene(path, before);
  tallies.push_back(fail_each("load", {Failing::malloc}, stride,
                              [&](Failing kind, long n) { return load_from(path, before, kind, n); }));
  const std::string obj = folder.write("plate.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const std::string off = folder.write("plate.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  for (const auto& [file, triangles] : {std::pair(obj, 2UL), std::pair(off, 2UL)}) {
    tallies.push_back(fail_each("import", {Failing::malloc}, stride,
                                [&](Failing kind, long n) { return import_from(file, triangles, kind, n); }));
  }
  const std::string ac = folder.write(
      "plate.ac",
      "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\n"
      "OBJECT poly\nname \"p\"\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x0\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 "
      "0\nkids 0\n");
  tallies.push_back(fail_each("converter", {Failing::write, Failing::malloc}, 10 * stride,
                              [&](Failing kind, long n) { return convert_from(ac, importer, preload, 1, kind, n); }));
  const int corrupted = corrupt(files, before, corruption_count);
  Tally all;
  for (const Tally& tally : tallies) {
    all.runs += tally.runs, all.failed += tally.failed, all.crashes += tally.crashes, all.bad += tally.bad;
  }
  std::printf("calls: runs=%d failures=%d crashes=%d bad_loads=%d\n", all.runs, all.failed, all.crashes, all.bad);
  return all.crashes + all.bad + corrupted == 0 ? 0 : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: failing_calls STRIDE CORRUPTIONS IMPORTER PRELOAD\n");
    return 2;
  }
  return collided::testing_support::run(std::atol(argv[1]), std::atoi(argv[2]), argv[3], argv[4]);
}

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "server/intake/child_process.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/mesh/tessellate.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/simplify/cross_beyond_shared.hpp"
#include "server/intake/simplify/simplify.hpp"
#include "tests/scenes/meshes.hpp"

// What the headers of the parts that reading is made of say of them.
namespace collided::engine {
namespace {

namespace fs = std::filesystem;

TEST(IntakeChildProcess, OnceCancelledItStaysCancelledAndIsNotAskedAgain) {
  int asked = 0;
  const ChildResult result = run_child({"/bin/sleep", "60"}, std::chrono::seconds(60), [&] { return ++asked == 2; });
  EXPECT_TRUE(result.cancelled);
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.signal, SIGKILL);
  EXPECT_EQ(asked, 2);
}

TEST(IntakeChildProcess, OfWhatItPrintsOnlySoMuchIsKept) {
  for (const std::size_t count : {std::size_t{5}, kMaxChildText, kMaxChildText + 1, 3 * kMaxChildText + 5}) {
    // The first letters are read by themselves, so that what is kept does not end where a piece that is read does.
    const std::string both = fmt::format(
        "printf 'a\\na'; printf 'b\\nb' >&2; sleep 0.1; yes '' | head -c {0}; yes '' | head -c {0} >&2", count - 3);
    const ChildResult result = run_child({"/bin/sh", "-c", both}, std::chrono::seconds(60), [] { return false; });
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.output.size(), std::min(count, kMaxChildText));
    EXPECT_EQ(result.errors.size(), std::min(count, kMaxChildText));
    EXPECT_TRUE(result.output.starts_with("a\na\n\n"));
    EXPECT_TRUE(result.errors.starts_with("b\nb\n\n"));
  }
}

// Seen from above they overlap, so that no side keeps them apart.
TEST(IntakeTriangleCrossing, WhatLiesOnOneSideOfThePlaneIsKeptApart) {
  for (const double up : {1.0, -1.0}) {
    const std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, up}, {2, 1, 2 * up}, {1, 2, up}, {1, 1, -up}};
    const TriangleSides sides(v, {0, 1, 2});
    EXPECT_TRUE(sides.keep_apart(v, {3, 4, 5})) << up;
    EXPECT_TRUE(sides.keep_apart(v, {0, 4, 5})) << up << ", a corner in common";
    EXPECT_TRUE(sides.keep_apart(v, {1, 0, 5})) << up << ", an edge in common";
    EXPECT_FALSE(sides.keep_apart(v, {6, 4, 5})) << up;
    EXPECT_FALSE(sides.keep_apart(v, {0, 6, 4})) << up;
  }
}

std::size_t mappings_of(const fs::path& path) {
  std::ifstream maps("/proc/self/maps");
  std::size_t count = 0;
  for (std::string line; std::getline(maps, line);) count += line.ends_with(path.string()) ? 1 : 0;
  return count;
}

TEST(IntakeFileBytes, AMappedFileIsMappedForAsLongAsItsBytesLive) {
  const fs::path path = fs::canonical(testing::TempDir()) / fmt::format("intake_mapped_{}", ::getpid());
  const auto page_bytes = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::ofstream(path, std::ios::binary) << std::string(3 * page_bytes + 1, 'x');
  for (const std::size_t forgotten_bytes : {std::size_t{0}, page_bytes, 4 * page_bytes}) {
    {
      FileBytes file(path.string(), FileBytes::Access::mapped, {});
      EXPECT_EQ(mappings_of(path), 1u);
      file.forget_before(forgotten_bytes);
      EXPECT_EQ(mappings_of(path), forgotten_bytes < file.bytes().size() ? 1u : 0u) << forgotten_bytes;
    }
    EXPECT_EQ(mappings_of(path), 0u) << forgotten_bytes;
  }
  fs::remove(path);
}

std::size_t handles_of(const fs::path& path) {
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    count += fs::read_symlink(entry.path(), gone) == path ? 1 : 0;
  }
  return count;
}

TEST(IntakeFileBytes, AFileIsOpenUntilAllOfItIsCopiedAndNoLonger) {
  const fs::path path = fs::canonical(testing::TempDir()) / fmt::format("intake_handles_{}", ::getpid());
  std::ofstream(path, std::ios::binary) << std::string(10'000, 'x');
  for (const bool fetches_all : {true, false}) {
    {
      FileBytes file(path.string(), FileBytes::Access::copied_as_asked, {});
      EXPECT_EQ(handles_of(path), 1u);
      file.fetch_before(5'000);
      EXPECT_EQ(handles_of(path), 1u);
      if (fetches_all) file.fetch_before(10'000);
      EXPECT_EQ(handles_of(path), fetches_all ? 0u : 1u);
    }
    EXPECT_EQ(handles_of(path), 0u) << fetches_all;
  }
  for (const FileBytes::Access access : {FileBytes::Access::copied, FileBytes::Access::mapped}) {
    FileBytes file(path.string(), access, {});
    EXPECT_EQ(handles_of(path), 0u);
  }
  EXPECT_THROW(FileBytes(path.string(), FileBytes::Access::copied, {.max_file_bytes = 9'999}), LoadError);
  EXPECT_EQ(handles_of(path), 0u) << "one that is refused";
  fs::remove(path);
}

// As idl/scene.fbs has it, so that files of other versions of this program, and of other programs, are read.
TEST(IntakeSceneBytes, TheChecksumIsTheOneThatTheFormatDefines) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("intake_checksum_{}.cscene", ::getpid());
  save_scene(path.string(), embedded_scene());
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  fs::remove(path);
  std::size_t found = 0;
  for (std::size_t place = 0; place + 8 <= bytes.size(); place += 8) {
    std::uint64_t checksum = 0;
    std::memcpy(&checksum, bytes.data() + place, sizeof checksum);
    if (checksum >> 32 != 1) continue;
    std::string without = bytes;
    without.replace(place, 8, 8, '\0');
    const uLong sum = crc32_z(0, reinterpret_cast<const Bytef*>(without.data()), without.size());
    found += checksum == (std::uint64_t{1} << 32 | sum) ? 1 : 0;
  }
  EXPECT_EQ(found, 1u);
}

TEST(IntakeSimplify, ProgressRisesFromNothingToAllOfWhatWasAskedFor) {
  const TriangleMesh mesh = scenes::icosphere(5, 1);
  for (const std::size_t target : {std::size_t{0}, mesh.triangles.size() / 2}) {
    std::vector<double> told;
    SimplifyReport report;
    simplify(mesh, {.triangles_at_most = target, .progress = [&](double fraction) { told.push_back(fraction); }},
             report);
    ASSERT_GT(told.size(), 1u) << target;
    EXPECT_EQ(told.front(), 0) << target;
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << target;
    // A collapse takes two triangles, and it is told each 4096 looked at.
    EXPECT_GT(told.back(), 0.25) << target;
    EXPECT_LE(told.back(), 1) << target;
  }
}

// Of degree 2 and two spans, knots 0 0 0 1 2 2 2: the first derivative's control points are 2, 3 and 12, the second's 1 and 9.
// The other way is of degree 1: 1 and 2.
TEST(IntakeTessellate, SecondDerivativesOfASplineOfSeveralSpansAreThoseByHand) {
  const std::array<double, 4> x{0, 1, 4, 10};
  const std::array<double, 3> z{0, 1, 3};
  SplinePatch along{2, 1, 4, {}};
  for (const double row : z) {
    for (const double column : x) along.points.emplace_back(column, 5 * row, column * row);
  }
  SplinePatch across{1, 2, 3, {}};
  for (const double row : x) {
    for (const double column : z) across.points.emplace_back(row, 5 * column, row * column);
  }
  const SecondDerivatives bounds = along.second_derivatives();
  EXPECT_NEAR(bounds.first_first, 9 * std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(bounds.first_second, 24, 1e-9);
  EXPECT_EQ(bounds.second_second, 0);
  const SecondDerivatives turned = across.second_derivatives();
  EXPECT_EQ(turned.first_first, 0);
  EXPECT_NEAR(turned.first_second, 24, 1e-9);
  EXPECT_NEAR(turned.second_second, 9 * std::sqrt(10.0), 1e-9);
}

TEST(IntakeTessellate, TheAxisAndTheCentreHaveTheParametersOfAPole) {
  EXPECT_EQ(sphere_parameters({0, 0, 2}).colatitude_rad, 0);
  EXPECT_EQ(sphere_parameters({0, 0, -2}).colatitude_rad, std::numbers::pi);
  EXPECT_EQ(sphere_parameters(Vec3::Zero()).colatitude_rad, 0) << "the one up";
  for (const Vec3& point : {Vec3(0, 0, 2), Vec3(0, 0, -2), Vec3(0, 0, 0)})
    EXPECT_EQ(sphere_parameters(point).longitude_rad, 0);
}

}  // namespace
}  // namespace collided::engine

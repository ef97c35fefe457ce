#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/files/files_program.hpp"

namespace {

namespace fs = std::filesystem;
using collided::test::Files;
using collided::test::kCube;
using nlohmann::json;
using Ran = collided::test::FilesRan;

/// Two panels; the second one's long edge passes a point of the first one's.
const std::string kPanels =
    "o left\nv 0 0 0\nv 1 0 0\nv 1 .5 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 5\nf 3 4 5\no right\nv 2 0 0\nv 2 1 0\nf 2 6 "
    "7\nf 2 7 4\n";

TEST_F(Files, CheckNamesEachDefectItsPlaceAndWhatTheServiceDoes) {
  const json found = checked(write("panels.obj", kPanels));
  EXPECT_EQ(found["t_vertices"], 1);
  EXPECT_EQ(found["cracks"], 0);
  const json& finding = found["findings"]["t_vertices"];
  EXPECT_EQ(finding["places"][0]["object"], "panels/right");
  EXPECT_EQ(finding["places"][0]["triangle"], 1);
  EXPECT_EQ(finding["places"][0]["detail"], "side 2 at vertex 2, gap 0 m");
  EXPECT_NE(finding["service"].get<std::string>().find("--mend"), std::string::npos);
  EXPECT_EQ(found["findings"]["boundary_edges"]["places"].size(), 9u);
}

TEST_F(Files, MendingIsSaidAndWhatComesAfterIsClean) {
  const std::string path = write("panels.obj", kPanels);
  const json found = checked(path + " --mend");
  EXPECT_EQ(found["t_vertices"], 0);
  EXPECT_EQ(found["self_intersections"], 0);
  EXPECT_EQ(found["triangles"], 6);
  EXPECT_EQ(found["mended"][0], "1 T-vertices: the edges cut there");
  // The worst boundary edges are named by the file's two triangles of that part, never by the third one.
  for (const json& place : found["findings"]["boundary_edges"]["places"]) {
    if (place["object"] == "panels/right") { EXPECT_LE(place["triangle"], 1); }
  }
  EXPECT_EQ(checked(path)["mended"].size(), 0u);
}

TEST_F(Files, ConvertMendsOnRequestAndTheSceneFileIsClean) {
  const std::string path = write("panels.obj", kPanels);
  const std::string out = (folder_ / "out.cscene").string();
  const Ran ran = run("convert " + path + " " + out + " --mend");
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.text.find("  mended   1 T-vertices: the edges cut there\n"), std::string::npos) << ran.text;
  EXPECT_EQ(checked(out)["t_vertices"], 0);
  run("convert " + path + " " + out);
  EXPECT_EQ(checked(out)["t_vertices"], 1);
}

TEST_F(Files, EdgesAreCountedByKind) {
  const json cube = checked(write("cube.obj", kCube) + " --eye 5,7,11 --crease 60");
  EXPECT_EQ(cube["edges"], 18);
  EXPECT_EQ(cube["crease_edges"], 12);
  EXPECT_EQ(cube["silhouette_edges"], 6);
  EXPECT_EQ(cube["boundary_edges"], 0);
  EXPECT_TRUE(cube["closed"] && cube["oriented"] && cube["manifold"]);
  EXPECT_TRUE(cube["findings"].empty());
  std::string two = kCube;
  two.replace(two.find("f 5 6"), 0, "usemtl red\n").replace(two.find("f 1 2 6"), 0, "usemtl blue\n");
  EXPECT_EQ(checked(write("two.obj", two))["material_edges"], 8);
  EXPECT_FALSE(cube.contains("unit_doubt"));
}

TEST_F(Files, UnitAxisAndOriginAreStated) {
  const json placed = checked(write("cube.obj", kCube) + " --unit mm --up y")["placed"];
  EXPECT_EQ(placed[0], "a unit of the file is 0.001 m, as asked");
  EXPECT_EQ(placed[1], "y is up and turned to z, as asked");
  EXPECT_EQ(placed[2], "the origin is that of the file");
  EXPECT_EQ(checked(write("cube.obj", kCube))["placed"][1], "z is up, since OBJ does not say; --up does");
}

TEST_F(Files, ASizeThatSuggestsAnotherUnitIsDoubted) {
  const json found = checked(write("big.obj", "v 0 0 0\nv 1210 0 0\nv 0 850 0\nf 1 2 3\n"));
  EXPECT_EQ(found["unit_doubt"], "1210 m across: if the file is in millimetres, it is 1.21 m (--unit mm)");
  EXPECT_TRUE(checked(write("small.obj", "v 0 0 0\nv 0.0005 0 0\nv 0 0.0005 0\nf 1 2 3\n")).contains("unit_doubt"));
  // A survey is large and far away, and that is what it should be.
  EXPECT_FALSE(checked(write("utm.obj", "v 4649000.1 500000 0\nv 4650200.2 500000 0\nv 4649000 500900 0\nf 1 2 3\n"))
                   .contains("unit_doubt"));
}

TEST_F(Files, SinglePrecisionFarFromTheOriginIsWarnedOf) {
  std::string text;
  for (int i = 0; i < 12; ++i) {
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "v %.9g %.9g %d\n",
                  static_cast<double>(4649000.3f + 0.7f * static_cast<float>(i)),
                  static_cast<double>(500000.1f * 7 + static_cast<float>(i * i)), i);
    text += line.data();
  }
  const json found = checked(write("far.obj", text + "f 1 2 3\n"));
  EXPECT_NE(found["warnings"][0].get<std::string>().find("written in single precision"), std::string::npos);
}

TEST_F(Files, LinksOfARobotAreCheckedEachAndAnSrdfFileIsTaken) {
  const std::string robot = write(
      "r.urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><mesh filename="package://p/cube.obj"/></geometry></collision></link>
    <link name="b"><collision><geometry><sphere radius="1"/></geometry></collision></link>
    <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>)");
  write("cube.obj", kCube);
  const std::string srdf = write("r.srdf", R"(<robot name="r"><disable_collisions link1="a" link2="b"/></robot>)");
  const json found = checked(robot + " --srdf " + srdf);
  EXPECT_EQ(found["objects"], 2);
  EXPECT_EQ(found["object_meshes"][0]["object"], "r/a");
  EXPECT_EQ(found["object_meshes"][0]["edges"], 18);
  EXPECT_TRUE(found["warnings"].empty());
  EXPECT_EQ(checked(robot)["warnings"].size(), 1u);
}

TEST_F(Files, MeshesOfObjectsAreMendedToo) {
  const std::string robot = write(
      "r.urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><mesh filename="panels.obj"/></geometry></collision></link>
    <link name="b"><collision><geometry><mesh filename="cube.obj"/></geometry></collision></link>
    <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>)");
  write("panels.obj", kPanels);
  write("cube.obj", kCube);
  EXPECT_EQ(checked(robot)["object_meshes"][0]["t_vertices"], 1);
  const json mended = checked(robot + " --mend");
  EXPECT_EQ(mended["mended"][0], "r/a: 1 T-vertices: the edges cut there");
  EXPECT_EQ(mended["mended"].back(), "nothing of the meshes of 1 objects: no T-vertex and no crack");
  const std::string saved = (folder_ / "r.cscene").string();
  ASSERT_EQ(run("convert " + robot + " " + saved + " --mend").code, 0);
  for (const json& found : {mended, checked(saved)}) {
    const json& panels = found["object_meshes"][0];
    EXPECT_EQ(panels["t_vertices"], 0);
    EXPECT_EQ(panels["triangles"], 6);
    // The piece, the sixth triangle of the mesh, is still called by the number of the file's triangle: 4.
    std::vector<int> named;
    for (const json& place : panels["findings"]["boundary_edges"]["places"]) named.push_back(place["triangle"]);
    EXPECT_EQ(*std::max_element(named.begin(), named.end()), 4);
    EXPECT_EQ(std::count(named.begin(), named.end(), 4), 1);
  }
}

/// A program on a terminal of its own, which sees what it writes.
class OnTerminal {
 public:
  explicit OnTerminal(const std::string& words) {
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      ::execl("/bin/sh", "sh", "-c", ("exec " + std::string(COLLIDED_FILES_BUILT) + " " + words).c_str(), nullptr);
      ::_exit(127);
    }
  }
  ~OnTerminal() {
    ::close(terminal_);
    if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// False: it ended before it wrote that.
  bool wait_for(const std::string& text) {
    std::array<char, 4096> piece{};
    while (seen_.find(text) == std::string::npos) {
      const ssize_t got = ::read(terminal_, piece.data(), piece.size());
      if (got <= 0) return false;
      seen_.append(piece.data(), static_cast<std::size_t>(got));
    }
    return true;
  }
  void press_ctrl_c() const { ASSERT_EQ(::write(terminal_, "\x03", 1), 1); }
  int exit_code() {
    wait_for("\a never written");
    int status = 0;
    ::waitpid(std::exchange(pid_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  const std::string& seen() const { return seen_; }

 private:
  int terminal_ = -1;
  pid_t pid_ = 0;
  std::string seen_;
};

/// A flat square of 2 * cells^2 triangles as binary STL.
std::string flat_stl(std::uint32_t cells) {
  std::string bytes(80, '\0');
  const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(2 * cells * cells);
  const auto triangle = [&](std::initializer_list<std::array<std::uint32_t, 2>> corners) {
    bytes.append(12, '\0');
    for (const auto& corner : corners)
      put(std::array<float, 3>{static_cast<float>(corner[0]), static_cast<float>(corner[1]), 0});
    bytes.append(2, '\0');
  };
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      triangle({{x, y}, {x + 1, y}, {x + 1, y + 1}});
      triangle({{x, y}, {x + 1, y + 1}, {x, y + 1}});
    }
  }
  return bytes;
}

TEST_F(Files, TheWidestCrackIsTheOneAskedInMetresOrByItsUnit) {
  std::string apart = kPanels;
  apart.replace(apart.find("v 1 .5 0"), 8, "v .99 .5 0");
  const std::string path = write("apart.obj", apart);
  EXPECT_NEAR(checked(path)["crack_m"].get<double>(), std::sqrt(5.0) * 1e-4, 1e-12);
  EXPECT_EQ(checked(path)["cracks"], 0);
  for (const char* crack : {"0.02", "0.02m", "20mm", "2cm"}) {
    const json found = checked(path + " --crack " + crack);
    EXPECT_NEAR(found["crack_m"].get<double>(), 0.02, 1e-15) << crack;
    EXPECT_EQ(found["cracks"], 1) << crack;
  }
}

TEST_F(Files, TheIndexIsToldByItsBytesATriangle) {
  const std::string path = write("flat.stl", flat_stl(30));
  const fs::path with = folder_ / "with.cscene";
  const fs::path without = folder_ / "without.cscene";
  const Ran ran = run("convert " + path + " " + with.string());
  ASSERT_EQ(run("convert " + path + " " + without.string() + " --no-index").code, 0);
  const std::size_t told = ran.text.find(" ms, ");
  ASSERT_NE(told, std::string::npos) << ran.text;
  const double index_bytes = 1800 * std::strtod(ran.text.c_str() + told + 5, nullptr);
  // Told to a tenth of a byte; in the file it is aligned and listed.
  const auto added_bytes = static_cast<double>(fs::file_size(with) - fs::file_size(without));
  EXPECT_LE(index_bytes, added_bytes + 90) << ran.text;
  EXPECT_GE(index_bytes, added_bytes - 90 - 512) << ran.text;
  EXPECT_GT(added_bytes, 10000);
}

TEST_F(Files, ThePageOfACheckHasEveryLineOfIt) {
  std::string bent = kPanels;
  bent.replace(bent.find("v 2 1 0"), 7, "v 2 1 0.25");
  const std::string placed =
      "  placed   a unit of the file is 1 m, since OBJ does not say; --unit does\n"
      "  placed   z is up, since OBJ does not say; --up does\n"
      "  placed   the origin is that of the file\n";
  const std::string head = "panels  2 parts, 5 triangles, 0 objects\n" + placed +
                           "  bounds   0 0 0  to  2 1 0.25\n"
                           "  surface  open, not manifold\n"
                           "  pieces   1\n"
                           "  points   7 vertices, 0 of them equal to an earlier one\n"
                           "  edges    12, 0 of them creases, 0 between parts\n";
  EXPECT_EQ(
      run("check -v " + write("panels.obj", bent)).text,
      head +
          "            1  T-vertices           kept; a ray may pass between their roundings; --mend cuts the edges "
          "there\n"
          "               panels/right triangle 1 side 2 at vertex 2, gap 0 m\n"
          "            9  boundary edges       kept; the surface is open: nothing is inside\n"
          "               the worst: panels/right triangle 0 side 1; panels/right triangle 1 side 1; panels/left "
          "triangle 0 side 0\n"
          "            2  pinched points       kept; several surfaces touch there\n"
          "               panels/left triangle 0 vertex 1; panels/left triangle 2 vertex 3\n"
          "            3  meet each other      normal where parts join or overlap; every triangle counts\n"
          "               panels/left triangle 0 with panels/right triangle 1; panels/left triangle 1 with "
          "panels/right triangle 1; panels/left triangle 2 with panels/right triangle 1\n");
  EXPECT_EQ(run("check " + write("panels.obj", bent)).text,
            head +
                "            1  T-vertices           kept; --mend cuts the edges there\n"
                "               right triangle 1 side 2 at vertex 2, gap 0 m\n"
                "            9  boundary edges       kept; the surface is open: nothing is inside\n"
                "               the worst: right triangle 0 side 1; right triangle 1 side 1\n"
                "            2  pinched points       kept; several surfaces touch there\n"
                "               left triangle 0 vertex 1; left triangle 2 vertex 3\n"
                "            3  meet each other      normal where parts join or overlap\n"
                "               left triangle 0 with right triangle 1\n"
                "  -v shows every place, --json gives it to programs\n");
  EXPECT_EQ(run("check " + write("cube.obj", kCube) + " --encodings --eye 5,7,11").text,
            "cube  1 part, 12 triangles, 0 objects\n" + placed +
                "  bounds   0 0 0  to  1 1 1\n"
                "  surface  closed, of one orientation, manifold: 'inside' has a meaning\n"
                "  pieces   1\n"
                "  points   8 vertices, 0 of them equal to an earlier one\n"
                "  edges    18, 12 of them creases, 0 between parts, 6 silhouettes from there\n"
                "  nothing is wrong with it\n"
                "  ENCODING                            BYTES   A TRIANGLE\n"
                "  list                                  864         72.0\n"
                "  fans                                  600         50.0\n"
                "  strips                                444         37.0\n"
                "  mesh                                  336         28.0\n");
}

// A building has faults of every kind and names of sixty characters; what matters still fits a terminal.
TEST_F(Files, TheCheckOfABuildingFitsAScreen) {
  const std::string house = "/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc";
  if (!fs::exists(house)) GTEST_SKIP() << house << " is not installed";
  const Ran brief = run("check " + house);
  if (brief.text.find("no Assimp") != std::string::npos) GTEST_SKIP() << "needs Assimp";
  EXPECT_LE(std::count(brief.text.begin(), brief.text.end(), '\n'), 24) << brief.text;
  EXPECT_NE(brief.text.find("normal where parts join"), std::string::npos) << brief.text;
  EXPECT_NE(brief.text.find("  placed   z is up, as IFC says\n"), std::string::npos) << brief.text;
  EXPECT_LT(brief.text.find("cracks"), brief.text.find("boundary edges")) << "what spoils answers comes first";
  std::istringstream lines(brief.text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  const Ran full = run("check -v " + house);
  EXPECT_GT(std::count(full.text.begin(), full.text.end(), '\n'), 28);
  EXPECT_NE(full.text.find("_16DNNqzfP2thtfaOflvsKA"), std::string::npos) << full.text;
}

// The index took no longer than the whole run; with the careful form, that is most of it.
TEST_F(Files, ThePageOfAConversionHasEveryLineOfIt) {
  const std::string out = (folder_ / "out.cscene").string();
  const std::string text = run("convert " + write("panels.obj", kPanels) + " " + out + " --origin 0,0.1,0").text;
  const std::size_t told = text.find("  index    ");
  ASSERT_NE(told, std::string::npos) << text;
  EXPECT_EQ(
      text.substr(0, told),
      "panels  2 parts, 5 triangles, 0 objects\n  origin   0,0.1,0 is now 0 0 0; 4 numbers were rounded by that\n");
  EXPECT_EQ(text.substr(text.find(" ms, ", told)),
            " ms, 102.4 bytes and 1.00 references a triangle\n"
            "  placed   a unit of the file is 1 m, since OBJ does not say; --unit does\n"
            "  placed   z is up, since OBJ does not say; --up does\n"
            "  placed   the origin is that of the file\n"
            "  written  " +
                out + "\n");
  const std::string flat = (folder_ / "flat.cscene").string();
  ASSERT_EQ(run("convert " + write("flat.stl", flat_stl(400)) + " " + flat + " --no-index").code, 0);
  const auto begin = std::chrono::steady_clock::now();
  const std::string best = run("convert " + flat + " " + out + " --index best").text;
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  const std::size_t index = best.find("  index    ");
  ASSERT_NE(index, std::string::npos) << best;
  const double index_ms = std::strtod(best.c_str() + index + 11, nullptr);
  EXPECT_GT(index_ms, 0);
  EXPECT_LE(index_ms, took.count()) << best;
}

TEST_F(Files, AShareOfTheTrianglesIsThatShareAndANumberThatNumber) {
  const std::string path = write("flat.stl", flat_stl(4));
  const std::string out = (folder_ / "out.cscene").string();
  for (const char* target : {"50%", "16", "49.9%"}) {
    const Ran ran = run("convert " + path + " " + out + " --cost length --to " + target);
    EXPECT_NE(ran.text.find("  simplify  16 of 32 triangles, "), std::string::npos) << target << ": " << ran.text;
    EXPECT_EQ(checked(out)["triangles"], 16) << target;
  }
  EXPECT_NE(run("convert " + path + " " + out + " --to 100%")
                .text.find("  simplify  nothing: 32 triangles are asked for, the file has 32\n"),
            std::string::npos);
  for (const char* target : {"0", "0%", "101%", "25%%", "%", "many"}) {
    const Ran ran = run("convert " + path + " " + out + " --cost length --to " + target);
    EXPECT_EQ(ran.code, 2) << target;
    EXPECT_NE(ran.text.find(std::string("error: --to '") + target +
                            "'; a number of triangles, or of per cent of them, is needed: 5000 or 10%\n"),
              std::string::npos)
        << ran.text;
  }
}

TEST_F(Files, ALongCheckShowsHowFarItIsAndEndsAtCtrlC) {
  const std::string path = write("flat.stl", flat_stl(900));
  OnTerminal check("check " + path);
  ASSERT_TRUE(check.wait_for("checking ")) << check.seen();
  ASSERT_TRUE(check.wait_for(" s left")) << check.seen();
  check.press_ctrl_c();
  EXPECT_EQ(check.exit_code(), 130) << check.seen();
  EXPECT_NE(check.seen().find("\x1b[Kinterrupted"), std::string::npos) << check.seen();
  EXPECT_EQ(check.seen().find("bounds"), std::string::npos) << "it went on to the end";
}

TEST_F(Files, NoProgressGoesIntoAPipe) {
  const std::string path = write("flat.stl", flat_stl(150));
  const Ran ran = run("check " + path);
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.text.find('\r'), std::string::npos);
}

TEST_F(Files, BadOptionsAreRefusedByName) {
  const std::string path = write("cube.obj", kCube);
  const auto refused = [&](const std::string& options) {
    const Ran ran = run("check " + path + " " + options);
    EXPECT_EQ(ran.code, 2) << options;
    return ran.text;
  };
  EXPECT_EQ(refused("--crack wide"), "error: --crack 'wide'; a length above 0 is needed, as 0.1mm or 2e-4\n");
  EXPECT_EQ(refused("--crack -- -1mm").substr(0, 6), "error:");
  EXPECT_EQ(refused("--eye 1,2"), "error: --eye '1,2'; three finite numbers are needed: X,Y,Z\n");
  EXPECT_EQ(refused("--crease 200").substr(0, 6), "error:");
}

TEST_F(Files, ImplicitAnswersRaysAndPointsOfAPolynomial) {
  const Ran hit = run("implicit x^2+y^2+z^2-1 0 0 5  0 0 -1 --json");
  EXPECT_EQ(hit.code, 0) << hit.text;
  const json answer = json::parse(hit.text);
  EXPECT_EQ(answer["answer"], "hit");
  EXPECT_LE(answer["low"].get<double>(), 4);
  EXPECT_GE(answer["high"].get<double>(), 4);
  EXPECT_NEAR(answer["normal"][2].get<double>(), 1, answer["normal_error"].get<double>());
  EXPECT_EQ(run("implicit x^2+y^2+z^2-1 -5 1 0 1 0 0").code, 0);
  // An option's number, and numbers below 0 behind an option without one.
  EXPECT_EQ(run("implicit x^2+y^2+z^2-1 --length 4 -5 -.5 0 1 0 0").text, "miss\n");
  EXPECT_EQ(run("implicit -x^2-y^2-z^2+1 --json -1 0 0").text, "{\"answer\":\"on\",\"by\":\"double\"}\n");
  EXPECT_EQ(run("implicit x^2+y^2+z^2-1 2 0 0").code, 1);
  const Ran singular = run("implicit x^2+y^2-z^2 -1 0 0  1 0 0");
  EXPECT_NE(singular.text.find("no normal: the gradient is 0 there"), std::string::npos) << singular.text;
}

TEST_F(Files, ImplicitTakesAFilesLineAndABatchAndSaysWhatItRefuses) {
  const std::string path = write(
      "a.surfaces", "globe sphere 1 count 6 4\nring implicit (x^2+y^2+z^2+3)^2 \\\n - 16*(x^2+y^2) in 0 -3 -1 3 3 1\n");
  EXPECT_EQ(run("implicit ring --file " + path + " 3 0 0").text, "on\n");
  EXPECT_EQ(run("implicit ring --file " + path + " -3 0 0").text, "outside\n");
  const Ran other = run("implicit globe --file " + path + " 1 0 0");
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.text.find("a.surfaces: line 1: 'globe' is of kind 'sphere', not implicit"), std::string::npos)
      << other.text;
  const std::string rays = write("rays", "0 0 5 0 0 -1\n1 1\n0,0,1\n\n");
  const Ran batch = run("implicit x^2+y^2+z^2-1 - < " + rays);
  EXPECT_EQ(batch.code, 6);
  EXPECT_NE(batch.text.find("on\n"), std::string::npos) << batch.text;
  EXPECT_NE(batch.text.find("stdin line 2: 2 numbers; a point X Y Z or a ray X Y Z DX DY DZ is needed"),
            std::string::npos)
      << batch.text;
  const Ran wrong = run("implicit x^9 0 0 0");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.text.find("column 3: exponent '9', allowed are 0 to 8"), std::string::npos) << wrong.text;
}

}  // namespace

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/oracle/seed.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

using test::append;
using test::complaint;
using test::load;

std::string text_ply(const std::string& body, int faces = 1) {
  return "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face " +
         std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

constexpr const char* kPlySquare = "0 0 0\n1 0 0\n1 1 0.1\n0 1 0.1\n";

template <class Number>
void append_big(std::string& bytes, Number value) {
  std::string little;
  append(little, value);
  bytes.append(little.rbegin(), little.rend());
}

// Properties in an order of their own, with a colour, a list and another element that nobody asked for.
std::string binary_ply(bool big) {
  std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty list uchar short "
                      "junk\nproperty float y\nproperty double x\nelement edge 2\nproperty int a\nproperty int b\n"
                      "element face 2\nproperty list uint uint vertex_index\nproperty uchar flags\nend_header\n";
  const auto put = [&](auto value) { big ? append_big(bytes, value) : append(bytes, value); };
  const double xy[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const auto& p : xy) {
    put(std::uint8_t{200});
    put(0.1);
    put(std::uint8_t{2});
    put(std::int16_t{-1});
    put(std::int16_t{-2});
    put(static_cast<float>(p[1]));
    put(p[0]);
  }
  for (int i = 0; i < 4; ++i) { put(std::int32_t{i}); }
  put(std::uint32_t{3});
  for (const std::uint32_t i : {0u, 1u, 2u}) { put(i); }
  put(std::uint8_t{0});
  put(std::uint32_t{3});
  for (const std::uint32_t i : {0u, 2u, 3u}) { put(i); }
  put(std::uint8_t{0});
  return bytes;
}

TEST(IntakePly, TextKeepsItsDigits) {
  const Scene scene = load("a.ply", text_ply(std::string(kPlySquare) + "4 0 1 2 3\n")).scene;
  EXPECT_EQ(scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(scene.mesh.vertices[2], Vec3(1, 1, 0.1));
  EXPECT_EQ(scene.parts.at(0).name, "a");
}

TEST(IntakePly, BothByteOrdersAndAnyOrderOfPropertiesAreRead) {
  for (const bool big : {false, true}) {
    const test::Loaded loaded = load("b.ply", binary_ply(big));
    ASSERT_EQ(loaded.scene.mesh.triangles.size(), 2u);
    EXPECT_EQ(loaded.scene.mesh.triangles[1], (TriangleCorners{0, 2, 3}));
    EXPECT_EQ(loaded.scene.mesh.vertices[2], Vec3(1, 1, 0.1));
    ASSERT_EQ(loaded.report.refused.size(), 1u);
    EXPECT_EQ(loaded.report.refused[0], "2 rows of element 'edge' left out");
  }
}

TEST(IntakePly, FacesMayStandBeforeTheirVertices) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(load("f.ply", text).scene.mesh.triangles.size(), 1u);
}

TEST(IntakePly, StripsKeepOneOrientation) {
  std::string text = text_ply(std::string(kPlySquare) + "9 0 1 3 2 -1 0 1 2 -1\n");
  text.replace(text.find("element face"), 12, "element tristrips");
  const Scene scene = load("s.ply", text).scene;
  ASSERT_EQ(scene.mesh.triangles.size(), 3u);
  EXPECT_EQ(scene.mesh.triangles[0], (TriangleCorners{0, 1, 3}));
  EXPECT_EQ(scene.mesh.triangles[1], (TriangleCorners{3, 1, 2}));
  EXPECT_EQ(scene.mesh.triangles[2], (TriangleCorners{0, 1, 2}));
}

TEST(IntakePly, AHeaderThatClaimsTooMuchIsRefusedBeforeAnythingIsAllocated) {
  std::string text = text_ply(std::string(kPlySquare) + std::string(40, ' '), 1'000'000'000);
  EXPECT_EQ(complaint("h.ply", text).substr(0, 60), "h.ply: header claims 1000000000 rows of element 'face', the ");
  text.replace(text.find("ascii"), 5, "binary_little_endian");
  EXPECT_EQ(complaint("h.ply", text).substr(0, 60), "h.ply: header claims 1000000000 rows of element 'face', the ");
  // No property, no bytes: a count without end costs nothing.
  EXPECT_EQ(complaint("h.ply", "ply\nformat ascii 1.0\nelement vertex 999999999999999\nend_header\n"),
            "h.ply: the header has no element 'vertex'. Nothing was loaded.");
}

TEST(IntakePly, ComplaintsNameThePlace) {
  const std::string square = kPlySquare;
  EXPECT_EQ(complaint("a.ply", text_ply(square + "3 0 1 4\n")),
            "a.ply: line 15: vertex number 4, allowed 0 to 3. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", text_ply(square + "3 0 1\n")),
            "a.ply: line 16: whole number is missing. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", text_ply(square + "3 0 1 -1\n")),
            "a.ply: line 15: vertex number -1, allowed 0 to 3. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", text_ply(std::string("0 0 inf\n") + kPlySquare)),
            "a.ply: line 11: vertex coordinate 'inf' is not finite. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", text_ply(square + "3 0 1 2\n").replace(0, 3, "plx")),
            "a.ply: line 1: the first line is not 'ply'. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n"),
            "a.ply: line 4: 'quad' is no type of PLY. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n"),
            "a.ply: element 'vertex' has no number 'z'. Nothing was loaded.");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\n"),
            "a.ply: line 3: the header has no 'end_header' line. Nothing was loaded.");
  const std::string binary = binary_ply(false);
  EXPECT_NE(complaint("a.ply", std::string_view(binary).substr(0, binary.size() - 1)).find("the file "),
            std::string::npos);
}

TEST(IntakePly, ACommentWithoutItsWordIsTakenBeforeTheElementsOnly) {
  std::string text = text_ply(std::string(kPlySquare) + "4 0 1 2 3\n");
  text.erase(text.find("comment "), 8);
  EXPECT_EQ(load("stray.ply", text).report.mended.size(), 1u);
  EXPECT_EQ(complaint("stray.ply", text, {.strict = true}),
            "stray.ply: line 3: 'by' is no word of a PLY header. Nothing was loaded.");
  text.insert(text.find("property"), "propertie float w\n");
  EXPECT_EQ(complaint("stray.ply", text),
            "stray.ply: line 5: 'propertie' is no word of a PLY header. Nothing was loaded.");
}

TEST(IntakePly, EveryCutOfABinaryFileIsRefused) {
  const std::string whole = binary_ply(true);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(complaint("cut.ply", std::string_view(whole).substr(0, size)), "loaded") << size;
  }
}

// x, y and z are told apart in every order, as every type of number, in text and in bytes.
TEST(IntakePly, EachCoordinateIsTakenFromItsOwnColumn) {
  for (const std::string order : {"xyz", "zyx", "yzx"}) {
    const auto header = [&](std::string_view format, std::string_view type) {
      std::string text = "ply\nformat " + std::string(format) + " 1.0\nelement vertex 3\n";
      for (const char axis : order) text += "property " + std::string(type) + " " + axis + "\n";
      return text + "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    };
    // farthest: a number that the type with or without a sign would read as another.
    const auto check = [&](auto number, std::string_view type, double farthest) {
      const std::vector<Vec3> expected{{1, 2, 3}, {4, 5, 6}, {7, 8, farthest}};
      std::string text = header("ascii", type);
      std::string little = header("binary_little_endian", type);
      std::string big = header("binary_big_endian", type);
      for (const Vec3& vertex : expected) {
        for (const char axis : order) {
          const double value = vertex[axis - 'x'];
          text += std::to_string(static_cast<long long>(value)) + " ";
          append(little, static_cast<decltype(number)>(value));
          append_big(big, static_cast<decltype(number)>(value));
        }
        text += "\n";
      }
      for (std::string* bytes : {&little, &big}) bytes->append("\3\2\0\1", 4);
      for (const std::string& whole : {text + "3 2 0 1\n", little, big}) {
        const Scene scene = load("c.ply", whole).scene;
        EXPECT_EQ(scene.mesh.vertices, expected) << order << ' ' << type;
        EXPECT_EQ(scene.mesh.triangles, (std::vector<TriangleCorners>{{2, 0, 1}})) << order << ' ' << type;
      }
    };
    check(std::int8_t{}, "char", -100);
    check(std::uint8_t{}, "uint8", 200);
    check(std::int16_t{}, "short", -300);
    check(std::uint16_t{}, "ushort", 40000);
    check(std::int32_t{}, "int32", -70000);
    check(std::uint32_t{}, "uint", 3e9);
    check(float{}, "float32", -10);
    check(double{}, "double", -10);
  }
}

// Rows of three corners counted by a byte are read in one go; counted by four bytes, as every other list is. The same
// faces, good and bad, must give the same triangles or the same complaint.
TEST(IntakePly, TrianglesReadInOneGoAreThoseOfAnyOtherList) {
  std::mt19937_64 random = oracle::seeded(20261125);
  const auto up_to = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    const bool big = round % 2 != 0, is_signed = round % 4 < 2;
    std::vector<std::vector<std::uint32_t>> faces(1 + static_cast<std::size_t>(up_to(6)));
    for (auto& face : faces) {
      face.resize(up_to(3) > 0 ? 3 : static_cast<std::size_t>(up_to(4)));
      for (std::uint32_t& corner : face) corner = static_cast<std::uint32_t>(up_to(3));
      if (up_to(20) == 0 && !face.empty()) face.back() = up_to(1) == 0 ? 4 : 0xffffffff;
    }
    const auto file = [&](std::string_view count_type, auto count) {
      std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                          "_endian 1.0\nelement vertex 4\nproperty uchar x\nproperty uchar y\nproperty uchar z\n" +
                          "element face " + std::to_string(faces.size()) + "\nproperty list " +
                          std::string(count_type) + (is_signed ? " int" : " uint") + " vertex_indices\nend_header\n";
      bytes.append("\0\0\0\1\0\0\1\1\0\0\1\0", 12);
      const auto put = [&](auto value) { big ? append_big(bytes, value) : append(bytes, value); };
      for (const auto& face : faces) {
        put(static_cast<decltype(count)>(face.size()));
        for (const std::uint32_t corner : face) put(corner);
      }
      return bytes;
    };
    const auto outcome = [&](const std::string& bytes) {
      std::vector<TriangleCorners> triangles;
      std::string text;
      try {
        const test::Loaded loaded = load("f.ply", bytes);
        triangles = loaded.scene.mesh.triangles;
        for (const std::string& line : loaded.report.refused) text += line;
      } catch (const LoadError& error) {
        text = error.what();
        // Where it stands differs, by the bytes of the counts.
        const std::size_t at = text.find("byte "), end = text.find(':', at);
        if (at != std::string::npos) text.erase(at, end - at);
        ++refused;
      }
      return std::pair(triangles, text);
    };
    EXPECT_EQ(outcome(file("uchar", std::uint8_t{})), outcome(file("uint", std::uint32_t{}))) << "round " << round;
  }
  EXPECT_GT(refused, 20);
  EXPECT_LT(refused, 600);
}

// What waits for the vertices waits as what it is.
TEST(IntakePly, StripsAndFacesBeforeTheirVerticesStayWhatTheyAre) {
  const std::string vertices = "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n";
  const std::string text =
      "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list uchar int vertex_indices\nelement face 1\n"
      "property list uchar int vertex_indices\n" +
      vertices + "end_header\n9 0 1 3 2 -1 0 1 2 -1\n4 0 1 2 3\n" + kPlySquare;
  EXPECT_EQ(load("s.ply", text).scene.mesh.triangles,
            (std::vector<TriangleCorners>{{0, 1, 3}, {3, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
}

// A corner that is named twice turns the strip and is no triangle of its own; the turns are counted on over it.
TEST(IntakePly, ACornerNamedTwiceSteersAStrip) {
  const auto strip = [](const std::string& numbers) {
    std::string text = text_ply(std::string(kPlySquare) + numbers);
    text.replace(text.find("element face"), 12, "element tristrips");
    return load("s.ply", text).scene.mesh.triangles;
  };
  EXPECT_EQ(strip("6 0 1 1 3 2 2\n"), (std::vector<TriangleCorners>{{1, 3, 2}}));
  EXPECT_EQ(strip("5 0 0 1 3 2\n"), (std::vector<TriangleCorners>{{1, 0, 3}, {1, 3, 2}}));
}

}  // namespace
}  // namespace collided::engine

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_saved.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using Bytes = std::vector<std::byte>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kHeaderBytes = 192;
constexpr std::size_t kNodeCountAt = 64;
constexpr std::size_t kRootAt = 112;
constexpr std::size_t kRootLowAt = 88;

/// Small triangles and long slanted ones, whose numbers are the last.
TriangleMesh needles(std::uint32_t small, std::uint32_t slanted) {
  TriangleMesh mesh = scenes::scattered(small, 0.05, 3);
  scenes::append(mesh, scenes::slanted(slanted, 1, 5));
  return mesh;
}

Bvh build(const TriangleMesh& mesh, BvhForm form = BvhForm::fast) {
  return Bvh::build(mesh, {.threads = 2, .progress = {}, .cancelled = {}, .form = form});
}

std::string refusal(const TriangleMesh& mesh, std::span<const std::byte> bytes) {
  const auto loaded = Bvh::load(mesh, bytes, nullptr, 2);
  return std::holds_alternative<BvhRefusal>(loaded) ? std::get<BvhRefusal>(loaded).reason : "loaded";
}

std::vector<std::uint32_t> candidates(const Bvh& tree, const TriangleMesh& mesh, const Ray& ray) {
  std::vector<std::uint32_t> all;
  WalkCost cost;
  const auto note = [&](std::uint32_t triangle, const Triangle&, double limit) {
    all.push_back(triangle);
    return limit;
  };
  tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, note, cost);
  return all;
}

struct AlignedCopy {
  explicit AlignedCopy(const Bytes& from) : blocks((from.size() + 63) / 64), size(from.size()) {
    std::memcpy(static_cast<void*>(blocks.data()), from.data(), from.size());
  }
  std::span<const std::byte> bytes() const { return {reinterpret_cast<const std::byte*>(blocks.data()), size}; }
  std::span<std::byte> bytes() { return {reinterpret_cast<std::byte*>(blocks.data()), size}; }

  struct alignas(64) Block {
    std::byte of[64];
  };
  std::vector<Block> blocks;
  std::size_t size;
};

TEST(BroadSaved, ALoadedTreeAnswersAsTheBuiltOneDoes) {
  std::mt19937_64 random = oracle::seeded(1);
  std::uniform_real_distribution<double> number(-1, 1);
  TriangleMesh in_floats = scenes::icosphere(3, 1);
  for (Vec3& vertex : in_floats.vertices) vertex = vertex.cast<float>().cast<double>();
  for (const TriangleMesh& mesh : {in_floats, scenes::terrain(40, 3, 9), needles(2000, 40), scenes::box({1, 1, 1})}) {
    for (const BvhForm form : {BvhForm::fast, BvhForm::best}) {
      const Bvh built = build(mesh, form);
      const auto kept = std::make_shared<const AlignedCopy>(built.saved(mesh));
      const auto in_place = Bvh::load(mesh, kept->bytes(), kept, 2);
      const auto copied = Bvh::load(mesh, kept->bytes(), nullptr, 1);
      ASSERT_TRUE(std::holds_alternative<Bvh>(in_place)) << std::get<BvhRefusal>(in_place).reason;
      ASSERT_TRUE(std::holds_alternative<Bvh>(copied)) << std::get<BvhRefusal>(copied).reason;
      const BvhReport& report = std::get<Bvh>(in_place).report();
      EXPECT_TRUE(report.is_loaded);
      EXPECT_EQ(report.depth, built.report().depth);
      EXPECT_EQ(report.references, built.report().references);
      EXPECT_EQ(report.bytes, built.report().bytes);
      EXPECT_EQ(report.split_triangles, built.report().split_triangles);
      EXPECT_EQ(std::get<Bvh>(copied).bounds().low, built.bounds().low);
      for (int i = 0; i < 200; ++i) {
        const double x = number(random);
        const double y = number(random);
        const Ray ray{{2 * x, 2 * y, 2}, {y - x, number(random), -1}};
        const auto expected = candidates(built, mesh, ray);
        EXPECT_EQ(candidates(std::get<Bvh>(in_place), mesh, ray), expected);
        EXPECT_EQ(candidates(std::get<Bvh>(copied), mesh, ray), expected);
      }
    }
  }
}

TEST(BroadSaved, AnEmptyTreeHasNothingToSave) {
  EXPECT_TRUE(build(TriangleMesh{}).saved(TriangleMesh{}).empty());
  EXPECT_EQ(refusal(TriangleMesh{}, {}), "it is cut short");
}

TEST(BroadSaved, EveryCutAndEveryFlippedBitIsSeen) {
  const TriangleMesh mesh = needles(40, 4);
  const Bytes whole = build(mesh, BvhForm::best).saved(mesh);
  for (std::size_t size = 0; size < whole.size(); size += 5) {
    EXPECT_NE(refusal(mesh, std::span(whole).first(size)), "loaded") << size;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes flipped = whole;
    flipped[at] ^= std::byte{1} << (at % 8);
    EXPECT_NE(refusal(mesh, flipped), "loaded") << at;
  }
}

TEST(BroadSaved, BelongsToItsMeshToTheLastBit) {
  TriangleMesh mesh = needles(40, 4);
  const Bytes saved = build(mesh).saved(mesh);
  EXPECT_EQ(refusal(mesh, saved), "loaded");
  mesh.vertices[17][1] = std::nextafter(mesh.vertices[17][1], 2.0);
  EXPECT_EQ(refusal(mesh, saved), "it is of another mesh");
  mesh.vertices.pop_back();
  EXPECT_EQ(refusal(mesh, saved), "it is of another mesh");
}

/// A saved tree that is changed as its author might, with right checksums.
class BroadTampered : public testing::Test {
 protected:
  using Change = std::function<void(std::span<std::byte>)>;

  bvh::Node* node(std::span<std::byte> bytes, std::size_t i) {
    return reinterpret_cast<bvh::Node*>(&bytes[kHeaderBytes]) + i;
  }
  std::uint64_t node_count(std::span<std::byte> bytes) const {
    std::uint64_t count;
    std::memcpy(&count, &bytes[kNodeCountAt], sizeof(count));
    return count;
  }
  bvh::Leaf* leaf(std::span<std::byte> bytes, std::size_t i) {
    return reinterpret_cast<bvh::Leaf*>(&bytes[kHeaderBytes + node_count(bytes) * sizeof(bvh::Node)]) + i;
  }
  /// Where the first child of a kind is.
  template <class Wanted>
  int slot_of(const bvh::Node& of, Wanted&& wanted) {
    for (int slot = 0; slot < bvh::kWidth; ++slot) {
      if (wanted(of.child[slot])) return slot;
    }
    ADD_FAILURE() << "no such child";
    return 0;
  }
  bvh::Ref& inner_child(std::span<std::byte> bytes) {
    bvh::Node& root = *node(bytes, 0);
    return root.child[slot_of(root, [](bvh::Ref ref) { return !bvh::is_leaf(ref) && ref != bvh::kNothing; })];
  }
  /// The first node with a child of a kind.
  std::size_t node_with(std::span<std::byte> bytes, const std::function<bool(bvh::Ref)>& wanted) {
    for (std::size_t i = 0; i < node_count(bytes); ++i) {
      for (const bvh::Ref ref : node(bytes, i)->child) {
        if (wanted(ref)) return i;
      }
    }
    ADD_FAILURE() << "no such node";
    return 0;
  }
  std::string after(const Change& change) {
    AlignedCopy copy(saved_);
    change(copy.bytes());
    bvh::seal(copy.bytes(), mesh_);
    return refusal(mesh_, copy.bytes());
  }

  TriangleMesh mesh_ = needles(500, 10);
  Bytes saved_ = build(mesh_, BvhForm::best).saved(mesh_);
};

TEST_F(BroadTampered, UntouchedIsTaken) {
  EXPECT_EQ(after([](std::span<std::byte>) {}), "loaded");
}

TEST_F(BroadTampered, NoReferenceLeadsOutOrInCircles) {
  EXPECT_EQ(after([&](std::span<std::byte> b) { inner_child(b) = 0; }),
            "a child is a node that does not follow its parent");
  EXPECT_EQ(after([&](std::span<std::byte> b) { inner_child(b) = static_cast<bvh::Ref>(node_count(b)); }),
            "a child is a node that does not follow its parent");
  EXPECT_EQ(after([&](std::span<std::byte> b) { inner_child(b) = 0x0fffffff; }),
            "a child is a node that does not follow its parent");
  EXPECT_EQ(after([&](std::span<std::byte> b) { inner_child(b) = bvh::leaf_ref(0x0ffffff0, 8); }),
            "a child is a leaf beyond the last");
  EXPECT_EQ(after([&](std::span<std::byte> b) { inner_child(b) = bvh::kNothing; }), "a missing child has a box");
  EXPECT_EQ(after([&](std::span<std::byte> b) {
              const bvh::Ref nothing = bvh::kNothing;
              std::memcpy(&b[kRootAt], &nothing, sizeof(nothing));
            }),
            "the root is not the first node");
  EXPECT_EQ(after([&](std::span<std::byte> b) {
              const bvh::Ref one = 1;
              std::memcpy(&b[kRootAt], &one, sizeof(one));
            }),
            "the root is not the first node");
  EXPECT_NE(after([&](std::span<std::byte> b) {
              bvh::Node& n = *node(b, 0);
              n.child[1] = n.child[0];
            }),
            "loaded");
}

TEST_F(BroadTampered, NoBoxIsTooSmallByTheLeastBit) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto shrink = [&](std::span<std::byte> bytes, std::size_t which,
                              const std::function<bool(bvh::Ref)>& wanted) {
        bvh::Node& n = *node(bytes, which);
        float& plane = n.plane[axis][side][slot_of(n, wanted)];
        plane = std::nextafter(plane, side == 0 ? kInfinity : -kInfinity);
      };
      const auto is_inner = [](bvh::Ref ref) { return !bvh::is_leaf(ref) && ref != bvh::kNothing; };
      EXPECT_EQ(after([&](std::span<std::byte> b) { shrink(b, node_with(b, is_inner), is_inner); }),
                "a box does not contain the boxes below it");
      EXPECT_EQ(after([&](std::span<std::byte> b) { shrink(b, node_with(b, bvh::is_leaf), bvh::is_leaf); }),
                "a triangle is not in the boxes of its leaves");
      EXPECT_EQ(after([&](std::span<std::byte> b) {
                  bvh::Node& n = *node(b, 0);
                  n.plane[axis][side][0] = std::numeric_limits<float>::quiet_NaN();
                }),
                "a box does not contain the boxes below it");
    }
  }
  EXPECT_EQ(after([&](std::span<std::byte> b) {
              const float beyond = -3e38f;
              std::memcpy(&b[kRootLowAt], &beyond, sizeof(beyond));
            }),
            "the root's box is not within the scene");
}

TEST_F(BroadTampered, NoTriangleIsLostOrMoved) {
  EXPECT_EQ(after([&](std::span<std::byte> b) { leaf(b, 0)->triangle[0] = 510; }),
            "a leaf has a triangle beyond the last");
  EXPECT_EQ(after([&](std::span<std::byte> b) { leaf(b, 0)->triangle[0] ^= 1; }),
            "a leaf's corners are not the mesh's");
  EXPECT_EQ(after([&](std::span<std::byte> b) { leaf(b, 2)->b[1][0] += 1e-3f; }),
            "a leaf's corners are not the mesh's");
  // A leaf that counts one triangle less is whole but for that one.
  EXPECT_EQ(after([&](std::span<std::byte> b) {
              bvh::Node& n = *node(b, node_with(b, bvh::is_leaf));
              const auto several = [](bvh::Ref ref) { return bvh::is_leaf(ref) && bvh::leaf_count(ref) > 1; };
              bvh::Ref& ref = n.child[slot_of(n, several)];
              const int last = bvh::leaf_count(ref) - 1;
              bvh::Leaf& short_leaf = *leaf(b, ref & bvh::kIndexMask);
              for (int axis = 0; axis < 3; ++axis) {
                short_leaf.a[axis][last] = short_leaf.b[axis][last] = short_leaf.c[axis][last] = 0;
              }
              short_leaf.triangle[last] = 0;
              ref = bvh::leaf_ref(ref & bvh::kIndexMask, last);
            }),
            "a triangle is not in the boxes of its leaves");
}

TEST_F(BroadTampered, EachOrderNamesEachChild) {
  EXPECT_EQ(after([&](std::span<std::byte> b) { node(b, 1)->order[5] ^= 7; }),
            "an order does not name each child once");
  EXPECT_EQ(after([&](std::span<std::byte> b) { node(b, 1)->order[5] |= 1u << 24; }),
            "an order does not name each child once");
}

// The last records say into how many pieces each split triangle went; other pieces are not those that the leaves hold.
TEST_F(BroadTampered, PiecesAreThoseThatTheLeavesHold) {
  ASSERT_GT(build(mesh_, BvhForm::best).report().split_triangles, 0u);
  EXPECT_EQ(after([](std::span<std::byte> b) { b[b.size() - 4] = std::byte{65}; }),
            "the split triangles are not in order");
  EXPECT_EQ(after([](std::span<std::byte> b) { b[b.size() - 4] = std::byte{1}; }),
            "the split triangles are not in order");
  EXPECT_EQ(after([](std::span<std::byte> b) { b[b.size() - 4] = std::byte{2}; }),
            "a triangle is not in the boxes of its leaves");
}

// Byte order, sizes of records, width: each alone makes it another machine's, and that is what is said.
TEST(BroadSaved, OneOfAnotherKindOfMachineIsSaidToBeThat) {
  const TriangleMesh mesh = scenes::box({1, 1, 1});
  const Bytes saved = build(mesh).saved(mesh);
  ASSERT_EQ(refusal(mesh, saved), "loaded");
  for (const std::size_t place : {12u, 16u, 20u, 24u}) {
    Bytes other = saved;
    other[place] ^= std::byte{1};
    EXPECT_EQ(refusal(mesh, other), "it is for another kind of machine") << place;
  }
}

}  // namespace
}  // namespace collided::engine

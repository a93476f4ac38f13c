// Convex parts of concave meshes, against volumes on paper.

#define XXH_INLINE_ALL
#include "mesh/convex_parts.h"

#include <gmock/gmock.h>
#include <xxhash.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "../meshes.h"
#include "mesh/triangle_soup.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

/// A prism over an outline in x and y, counter-clockwise, of that height along z; `fans`: triangles of the outline.
MeshData prism(const std::vector<Eigen::Vector2d>& outline, const Triangles& fans, double height) {
  const auto count = static_cast<std::uint32_t>(outline.size());
  std::vector<Vector3d> vertices;
  for (const double z : {0.0, height})
    for (const Eigen::Vector2d& point : outline) vertices.push_back({point.x(), point.y(), z});
  Triangles triangles;
  for (const auto& [a, b, c] : fans) {
    triangles.push_back({c, b, a});
    triangles.push_back({count + a, count + b, count + c});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    triangles.push_back({i, next, count + i});
    triangles.push_back({next, count + next, count + i});
  }
  return mesh_of({part_of(vertices, std::move(triangles))});
}

/// An angle of two legs of 1 m, 0.2 m thick and wide: 0.072 m³; its hull has 0.136 m³.
MeshData angle() {
  return prism({{0, 0}, {1, 0}, {1, 0.2}, {0.2, 0.2}, {0.2, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}},
               0.2);
}

/// A channel: 1 m wide, walls of 0.1 m, 0.5 m high, 0.3 m long: 0.054 m³.
MeshData channel() {
  return prism({{0, 0}, {1, 0}, {1, 0.5}, {0.9, 0.5}, {0.9, 0.1}, {0.1, 0.1}, {0.1, 0.5}, {0, 0.5}},
               {{0, 1, 4}, {1, 2, 3}, {1, 3, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}}, 0.3);
}

MeshData torus(double radius, double tube, int around, int across) {
  std::vector<Vector3d> vertices;
  Triangles triangles;
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % around) * across + j % across); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * M_PI * i / around, v = 2.0 * M_PI * j / across, r = radius + tube * std::cos(v);
      vertices.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh_of({part_of(vertices, std::move(triangles))});
}

ConvexHulls parts_of(const MeshData& mesh) {
  auto parts = convex_parts(mesh);
  EXPECT_TRUE(parts.ok()) << to_string(parts.errors());
  return *std::move(parts);
}

double volume_of(const ConvexHulls& hulls) {
  double sum = 0.0;
  for (const ConvexHull& hull : hulls.hulls) sum += volume(hull);
  return sum;
}

/// Distance of a point outside the nearest hull; negative inside [m].
double outside(const ConvexHulls& hulls, const Vector3d& point) {
  double nearest = unlimited;
  for (const ConvexHull& hull : hulls.hulls) {
    double out = -unlimited;
    for (const std::vector<int>& face : hull.faces) {
      const auto at = [&](std::size_t i) { return hull.vertices[static_cast<std::size_t>(face[i])]; };
      Vector3d normal = Vector3d::Zero();
      for (std::size_t i = 1; i + 1 < face.size(); ++i) normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
      out = std::max(out, normal.normalized().dot(point - at(0)));
    }
    nearest = std::min(nearest, out);
  }
  return nearest;
}

TEST(TriangleSoup, KeepsItsVolumeWhenItIsCut) {
  for (const MeshData& mesh : {angle(), channel(), torus(0.5, 0.1, 24, 12)}) {
    const TriangleSoup whole = object_of(mesh, 0);
    ASSERT_TRUE(is_closed(whole));
    for (const Vector3d& normal :
         {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0.6, 0.0, 0.8), Vector3d(0.48, 0.64, 0.6)})
      for (const double offset : {0.0, 0.1, 0.2, 0.33}) {
        const auto [behind, before] = cut(whole, {normal, offset}, 1e-9);
        EXPECT_TRUE(is_closed(behind));
        EXPECT_TRUE(is_closed(before));
        EXPECT_NEAR(volume(behind) + volume(before), volume(whole), 1e-9);
        for (const Vector3d& vertex : behind.vertices) EXPECT_LE(normal.dot(vertex), offset + 1e-9);
        const auto [lower, upper] = cut(before, {Vector3d::UnitZ(), 0.05}, 1e-9);  // cuts the first section, too
        EXPECT_NEAR(volume(lower) + volume(upper), volume(before), 1e-9);
      }
  }
}

TEST(ConvexParts, OfAConvexMeshAreItsHull) {
  const MeshData box = mesh_of({box_part({0.3, 0.2, 0.1})});
  EXPECT_TRUE(is_convex(box, 1e-6));
  const ConvexHulls parts = parts_of(box);
  ASSERT_EQ(parts.hulls.size(), 1u);
  EXPECT_EQ(parts.hulls[0].vertices, convex_hulls(box)->hulls[0].vertices);
  EXPECT_TRUE(parts.remarks.empty());
}

TEST(ConvexParts, OfAnAngleAreItsTwoLegs) {
  EXPECT_FALSE(is_convex(angle(), tolerated_excess));
  const ConvexHulls parts = parts_of(angle());
  ASSERT_EQ(parts.hulls.size(), 2u);
  EXPECT_NEAR(volume_of(parts), 0.072, 1e-8);
  ASSERT_EQ(parts.remarks.size(), 1u);
  EXPECT_EQ(parts.remarks[0].severity, Severity::note);
  EXPECT_THAT(parts.remarks[0].message,
              HasSubstr("it has a convex hull that fills 88.9 % more than its volume: contact "
                        "takes 2 convex parts"));
}

TEST(ConvexParts, OfAChannelAreItsThreeWalls) {
  const ConvexHulls parts = parts_of(channel());
  ASSERT_EQ(parts.hulls.size(), 3u);
  EXPECT_GT(volume_of(parts), 0.054 - 1e-8);
  EXPECT_LT(volume_of(parts), 0.054 * (1.0 + tolerated_excess));
}

TEST(ConvexParts, OfARingLeaveItsHoleOpen) {
  const MeshData ring = torus(0.5, 0.1, 48, 16);
  const ConvexHulls parts = parts_of(ring);
  EXPECT_GE(parts.hulls.size(), 8u);
  EXPECT_LE(parts.hulls.size(), max_convex_parts);
  const double true_volume = volume(object_of(ring, 0));
  EXPECT_LT(volume_of(parts), 1.2 * true_volume);
  EXPECT_GT(volume_of(parts), true_volume);
  EXPECT_GT(outside(parts, Vector3d::Zero()), 0.35);
  for (const Eigen::Vector3f& vertex : ring.parts[0].vertices) EXPECT_LT(outside(parts, vertex.cast<double>()), 2e-3);
}

TEST(ConvexParts, OfAnOpenMeshEmptyItsHull) {
  MeshData open = angle();
  open.parts[0].triangles.pop_back();
  const ConvexHulls parts = parts_of(open);
  EXPECT_EQ(parts.hulls.size(), 2u);
  ASSERT_EQ(parts.remarks.size(), 1u);
  EXPECT_THAT(parts.remarks[0].message, HasSubstr("it isn't closed, so that its volume is unknown"));
}

/// Four open rings in nearly the same place: their parts together fill more than the hull of all.
TEST(ConvexParts, OfOpenMeshesInEachOtherLeaveTheirHoleOpen) {
  const MeshPart ring = torus(0.5, 0.1, 48, 16).parts[0];
  std::vector<Vector3d> vertices;
  Triangles triangles;
  for (int copy = 0; copy < 4; ++copy) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Eigen::Vector3f& vertex : ring.vertices)
      vertices.push_back(vertex.cast<double>() + Vector3d::Constant(0.01 * copy));
    for (const auto& [a, b, c] : ring.triangles) triangles.push_back({a + first, b + first, c + first});
    triangles.pop_back();
  }
  const MeshData rings = mesh_of({part_of(vertices, std::move(triangles))});
  const ConvexHulls parts = parts_of(rings);
  EXPECT_GT(volume_of(parts), volume_of(*convex_hulls(rings)));
  EXPECT_GT(outside(parts, Vector3d::Zero()), 0.1) << "the hull of all contains it";
  ASSERT_EQ(parts.remarks.size(), 1u);
  EXPECT_THAT(parts.remarks[0].message, testing::EndsWith("convex parts, which overlap each other"));
}

void expect_same(const ConvexHulls& one, const ConvexHulls& two) {
  ASSERT_EQ(one.hulls.size(), two.hulls.size());
  for (std::size_t i = 0; i < one.hulls.size(); ++i) {
    EXPECT_EQ(one.hulls[i].vertices, two.hulls[i].vertices);
    EXPECT_EQ(one.hulls[i].faces, two.hulls[i].faces);
  }
  EXPECT_EQ(to_string(one.remarks), to_string(two.remarks));
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  return {std::filesystem::directory_iterator(folder), {}};
}

TEST(ConvexParts, AreTheSameInEveryRun) {
  expect_same(parts_of(torus(0.5, 0.1, 48, 16)), parts_of(torus(0.5, 0.1, 48, 16)));
}

std::uint64_t hash_of(const ConvexHulls& hulls) {
  std::uint64_t hash = hulls_version;
  for (const ConvexHull& hull : hulls.hulls) {
    for (const Vector3d& vertex : hull.vertices) hash = XXH3_64bits_withSeed(vertex.data(), sizeof vertex, hash);
    for (const std::vector<int>& face : hull.faces)
      hash = XXH3_64bits_withSeed(face.data(), face.size() * sizeof face[0], hash);
  }
  return hash;
}

/// A ball of more than 500 triangles, whose hull is thinned.
MeshData fine_ball() { return mesh_of({globe_part(0.3, 24, 16)}); }

/// If a hash changes, convex_parts() or judged_hulls() has changed: then hulls_version has to, or stores of users keep
/// old hulls.
TEST(ConvexParts, OfThisVersionHaveThisHash) {
  const std::uint64_t hash = hash_of(parts_of(torus(0.5, 0.1, 48, 16)));
  EXPECT_EQ(hash, 0xf434506677de7223u) << std::hex << hash;
}

TEST(ConvexHulls, OfThisVersionHaveThisHash) {
  const std::uint64_t hash = hash_of(*judged_hulls(fine_ball()));
  EXPECT_EQ(hash, 0x7f7db15b553bf0a4u) << std::hex << hash;
}

ConvexHulls kept_parts(const MeshData& mesh, const HullStore& store) {
  auto parts = contact_hulls(mesh, MeshContact::parts, store);
  EXPECT_TRUE(parts.ok()) << to_string(parts.errors());
  return *std::move(parts);
}

void expect_same_remarks(const ConvexHulls& a, const ConvexHulls& b) {
  EXPECT_EQ(to_string(a.remarks), to_string(b.remarks));
  ASSERT_EQ(a.remarks.size(), b.remarks.size());
  for (std::size_t i = 0; i < a.remarks.size(); ++i) EXPECT_EQ(a.remarks[i].severity, b.remarks[i].severity);
}

TEST(HullStore, GivesThePartsThatWereComputed) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.path() / "parts");
  const ConvexHulls first = kept_parts(channel(), store);
  ASSERT_EQ(files_in(folder.path() / "parts").size(), 1u);
  const ConvexHulls second = kept_parts(channel(), store);
  expect_same(first, parts_of(channel()));
  expect_same(second, first);
  ASSERT_FALSE(second.remarks.empty());
  expect_same_remarks(second, first);
}

TEST(HullStore, KeepsHullsOfFineMeshesWithTheirRemarks) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.path());
  for (const MeshContact contact : {MeshContact::hull, MeshContact::parts}) {
    const ConvexHulls first = *contact_hulls(fine_ball(), contact, store);
    EXPECT_THAT(to_string(first.remarks), HasSubstr("contact takes 128 of them"));
    const auto kept = store.find(fine_ball(), contact);
    ASSERT_TRUE(kept);
    expect_same(*kept, first);
    expect_same_remarks(*kept, first);
  }
  EXPECT_EQ(files_in(folder.path()).size(), 2u);
}

TEST(HullStore, KeepsNoHullThatTakesAMoment) {
  const test::TemporaryFolder folder;
  for (const MeshContact contact : {MeshContact::hull, MeshContact::parts})
    (void)contact_hulls(mesh_of({box_part({0.3, 0.2, 0.1})}), contact, HullStore(folder.path()));
  EXPECT_EQ(files_in(folder.path()).size(), 0u);
}

TEST(HullStore, IsAskedBeforePartsAreComputed) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.path());
  store.keep(channel(), MeshContact::parts, parts_of(angle()));
  expect_same(kept_parts(channel(), store), parts_of(angle()));
  expect_same(kept_parts(angle(), store), parts_of(angle()));
  expect_same(kept_parts(torus(0.5, 0.1, 24, 12), store), parts_of(torus(0.5, 0.1, 24, 12)));
  EXPECT_EQ(files_in(folder.path()).size(), 3u);
}

TEST(HullStore, TellsMeshesApartByTheirTrianglesAndObjects) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.path());
  store.keep(channel(), MeshContact::parts, parts_of(channel()));
  MeshData turned = channel(), of_two = channel();
  std::swap(turned.parts[0].triangles[0][0], turned.parts[0].triangles[0][1]);
  of_two.parts[0].object = 1;
  EXPECT_TRUE(store.find(channel(), MeshContact::parts));
  EXPECT_FALSE(store.find(channel(), MeshContact::hull));
  EXPECT_FALSE(store.find(turned, MeshContact::parts));
  EXPECT_FALSE(store.find(of_two, MeshContact::parts));
}

TEST(HullStore, OfDamagedFilesIsEmpty) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.path());
  const ConvexHulls parts = kept_parts(channel(), store);
  const std::filesystem::path file = files_in(folder.path()).at(0);
  const std::string whole = test::read_file(file);
  std::string changed = whole, many = whole;
  changed[25] ^= 1;
  many[15] = '\x7f';  // the number of coordinates
  for (const std::string& bytes :
       {changed, many, whole.substr(0, 100), whole.substr(8), std::string(), whole + "01234567"}) {
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_FALSE(store.find(channel(), MeshContact::parts)) << bytes.size();
    expect_same(kept_parts(channel(), store), parts);
    EXPECT_TRUE(store.find(channel(), MeshContact::parts)) << "it is written anew";
  }
}

TEST(HullStore, ThatCannotBeWrittenIsDoneWithout) {
  const test::TemporaryFolder folder;
  const HullStore store(folder.write("a_file", "") / "parts");
  expect_same(kept_parts(channel(), store), parts_of(channel()));
}

class PlaceOfHullStore : public ::testing::Test {
 protected:
  ~PlaceOfHullStore() override {
    for (const auto& [name, value] : before_) value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
  }
  void set(const char* name, const std::string& value) {
    if (!before_.contains(name)) {
      const char* old = std::getenv(name);
      before_[name] = old ? std::optional<std::string>(old) : std::nullopt;
    }
    ::setenv(name, value.c_str(), 1);
  }
  bool has_parts(const std::filesystem::path& folder) const {
    (void)contact_hulls(channel(), MeshContact::parts, HullStore::of_user());
    return std::filesystem::is_directory(folder / "hulls");
  }
  const test::TemporaryFolder folder_;

 private:
  std::map<const char*, std::optional<std::string>> before_;
};

TEST_F(PlaceOfHullStore, IsStatedByTheEnvironment) {
  const auto& at = folder_.path();
  set("HOME", at / "home");
  set("XDG_CACHE_HOME", "");
  set("REHEARSE_CACHE", "off");
  EXPECT_FALSE(has_parts(at / "home/.cache/rehearse"));
  set("REHEARSE_CACHE", "");
  EXPECT_TRUE(has_parts(at / "home/.cache/rehearse"));
  set("XDG_CACHE_HOME", at / "caches");
  EXPECT_TRUE(has_parts(at / "caches/rehearse"));
  set("REHEARSE_CACHE", at / "stated");
  EXPECT_TRUE(has_parts(at / "stated"));
}

TEST(ConvexHulls, OfAConcaveObjectAreRemarkedWithTheirExcess) {
  const auto hulls = judged_hulls(angle());
  ASSERT_TRUE(hulls.ok());
  ASSERT_EQ(hulls->remarks.size(), 1u);
  EXPECT_THAT(hulls->remarks[0].message, HasSubstr("it has a convex hull that fills 88.9 % more than its volume"));
  EXPECT_TRUE(judged_hulls(mesh_of({box_part({0.3, 0.2, 0.1})}))->remarks.empty());
}

}  // namespace
}  // namespace rehearse

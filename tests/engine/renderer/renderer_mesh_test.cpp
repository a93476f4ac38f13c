// Meshes in pictures: colours, textures, both sides, depth, shadows.
#include "mesh_shapes.h"
#include "scene.h"

#include <limits>

namespace rehearse {
namespace {

const Color white{1.0f, 1.0f, 1.0f, 1.0f};

/// The picture of a camera at the origin, with shapes in front of it.
Frame seen(const std::vector<Shape>& shapes, const Camera& camera, const Color& color = white) {
  const auto renderer = make_renderer({Color(0, 0, 0, 1)});
  for (const Shape& shape : shapes) renderer->add(shape, color);
  return renderer->draw(camera, at_origin);
}

/// A camera whose picture is exactly a rectangle of 4 x 2 m that is 10 m away.
Camera camera_on_4_by_2(int pixels_a_meter) {
  return camera_of(4 * pixels_a_meter, 2 * pixels_a_meter, 2.0 * std::atan(0.1));
}

Hue hue_in_the_middle(const Shape& shape, const Color& color) {
  return hue(pixel(seen({shape}, camera_of(1, 1, 0.1), color).color, 0, 0));
}

TEST(RendererMesh, ShowsEachTexelWhereItsCoordinatesSay) {
  const std::vector<std::array<std::uint8_t, 4>> texels{
      {255, 0, 0, 255},   {0, 255, 0, 255},   {0, 0, 255, 255},     {255, 255, 0, 255},  // the top row
      {0, 255, 255, 255}, {255, 0, 255, 255}, {255, 255, 255, 255}, {0, 0, 0, 255}};
  const Camera camera = camera_on_4_by_2(20);
  const Shape plain = shape_at(mesh_of({quad(4, 2)}), {0, 0, -10});
  const Shape textured = shape_at(mesh_of({with_texture(quad(4, 2), texture_of(4, 2, texels))}), {0, 0, -10});
  const Image light = seen({plain}, camera).color;
  const Image image = seen({textured}, camera).color;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 4; ++column) {
      // the four pixels around the texel's centre are 1/40 of a texel beside it
      const int x = 20 * column + 10, y = 20 * row + 10;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const int full = pixel(light, x, y)[channel];
        EXPECT_GT(full, 100);
        const double share = texels[static_cast<std::size_t>(4 * row + column)][channel] / 255.0;
        EXPECT_NEAR(pixel(image, x, y)[channel], share * full, 0.11 * full) << row << ", " << column;
      }
    }
  }
}

TEST(RendererMesh, RepeatsATextureBeyondItsEdges) {
  const auto red_over_blue = texture_of(1, 2, {{255, 0, 0, 255}, {0, 0, 255, 255}});
  const Image image =
      seen({shape_at(mesh_of({with_texture(quad(4, 2, 2.0f), red_over_blue)}), {0, 0, -10})}, camera_on_4_by_2(20))
          .color;
  for (const auto& [y, expected] :
       {std::pair(5, Hue::reddish), {15, Hue::bluish}, {25, Hue::reddish}, {35, Hue::bluish}})
    EXPECT_EQ(hue(pixel(image, 40, y)), expected) << y;
}

TEST(RendererMesh, ShowsTheMeanOfATextureThatIsMuchFinerThanThePixels) {
  std::vector<std::array<std::uint8_t, 4>> stripes;
  for (int i = 0; i < 256 * 256; ++i)
    stripes.push_back(i % 2 == 0 ? std::array<std::uint8_t, 4>{255, 255, 255, 255}
                                 : std::array<std::uint8_t, 4>{0, 0, 0, 255});
  const MeshPart part = with_texture(quad(4, 2), texture_of(256, 256, stripes));
  const Camera camera = camera_on_4_by_2(5);
  const int full = pixel(seen({shape_at(mesh_of({quad(4, 2)}), {0, 0, -10})}, camera).color, 10, 5)[1];
  const Image image = seen({shape_at(mesh_of({part}), {0, 0, -10})}, camera).color;
  for (int x = 0; x < image.width; ++x) EXPECT_NEAR(pixel(image, x, 5)[1], 0.5 * full, 3.0) << x;
}

TEST(RendererMesh, MultipliesATextureWithTheColour) {
  const auto yellow = texture_of(1, 1, {{255, 255, 0, 255}});
  const MeshPart part = with_color(with_texture(quad(1, 1), yellow), {0.0f, 1.0f, 1.0f, 1.0f});
  EXPECT_EQ(hue_in_the_middle(shape_at(mesh_of({part}), {0, 0, -3}), red), Hue::greenish);
}

TEST(RendererMesh, TakesThePartsColourThenTheShapesThenTheDefault) {
  Shape shape = shape_at(mesh_of({with_color(quad(1, 1), green)}), {0, 0, -3});
  shape.color = blue;
  EXPECT_EQ(hue_in_the_middle(shape, red), Hue::greenish);
  shape.geometry = mesh_of({quad(1, 1)});
  EXPECT_EQ(hue_in_the_middle(shape, red), Hue::bluish);
  shape.color.reset();
  EXPECT_EQ(hue_in_the_middle(shape, red), Hue::reddish);
}

TEST(RendererMesh, TakesTheShapesColourBeforeADefaultOfTheMeshFile) {
  MeshPart part = with_color(quad(1, 1), green);
  part.has_default_color = true;
  Shape shape = shape_at(mesh_of({part}), {0, 0, -3});
  EXPECT_EQ(hue_in_the_middle(shape, red), Hue::greenish);
  shape.color = blue;
  EXPECT_EQ(hue_in_the_middle(shape, red), Hue::bluish);
}

TEST(RendererMesh, ColoursEachOfItsPartsAndEachOfItsShapes) {
  const Mesh mesh = mesh_of({with_color(moved(quad(1, 1), {0, 0.5f, 0}), red), moved(quad(1, 1), {0, -0.5f, 0})});
  Shape left = shape_at(mesh, {-1.5, 0, -10}), right = shape_at(mesh, {1.5, 0, -10});
  left.color = green;
  right.color = blue;
  const Image image = seen({left, right}, camera_on_4_by_2(10)).color;
  EXPECT_EQ(hue(pixel(image, 5, 5)), Hue::reddish);
  EXPECT_EQ(hue(pixel(image, 35, 5)), Hue::reddish);
  EXPECT_EQ(hue(pixel(image, 5, 15)), Hue::greenish);
  EXPECT_EQ(hue(pixel(image, 35, 15)), Hue::bluish);
  EXPECT_EQ(hue(pixel(image, 20, 10)), Hue::none);
}

TEST(RendererMesh, LooksTheSameHoweverItIsWoundAndWhereverItsNormalsPoint) {
  Shape shape = shape_at(mesh_of({ball(0.5, 24)}), {0.1, 0.2, -2});
  const Frame right = seen({shape}, camera_of(96, 96));
  const MeshPart part = ball(0.5, 24);
  for (const MeshPart& other :
       {wound_backwards(part), with_normals_turned(part), with_normals_turned(wound_backwards(part))}) {
    shape.geometry = mesh_of({other});
    const Frame frame = seen({shape}, camera_of(96, 96));
    for (std::size_t i = 0; i < frame.color.pixels.size(); ++i)
      ASSERT_NEAR(frame.color.pixels[i], right.color.pixels[i], 1) << i;
    for (std::size_t i = 0; i < frame.depth.meters.size(); ++i) {
      const float expected = right.depth.meters[i], depth = frame.depth.meters[i];
      ASSERT_TRUE(depth == expected || std::abs(depth - expected) < 1e-5f) << i << ": " << depth << ", " << expected;
    }
  }
}

TEST(RendererMesh, ShowsTheInsideOfAnOpenSurface) {
  const auto renderer = make_renderer();
  const int number = renderer->add(shape_at(mesh_of({quad(1, 1)}), {0, 0, 0}), red);
  for (const double angle : {0.0, std::numbers::pi}) {
    Eigen::Isometry3d pose(Eigen::Translation3d(0, 0, -3) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    renderer->set_link_pose(number, pose);
    EXPECT_EQ(hue(pixel(renderer->draw(camera_of(1, 1, 0.1), at_origin).color, 0, 0)), Hue::reddish) << angle;
  }
}

/// The hue in the picture of a camera inside the mesh, with a blue shape outside.
Hue hue_from_inside(const std::vector<MeshPart>& parts) {
  Shape outside = shape_at(Box{{9, 9, 1}}, {0, 0, -6});
  outside.color = blue;
  return hue(pixel(seen({shape_at(mesh_of(parts), {0, 0, 0}), outside}, camera_of(1, 1, 0.1), red).color, 0, 0));
}

TEST(RendererMesh, ThatIsClosedLetsACameraLookOutOfIt) {
  EXPECT_EQ(hue_from_inside({cuboid({1, 1, 1})}), Hue::bluish);
  EXPECT_EQ(hue_from_inside({ball(0.5, 10)}), Hue::bluish);
  EXPECT_EQ(hue_from_inside({with_normals_turned(ball(0.5, 10))}), Hue::bluish);
}

TEST(RendererMesh, ThatIsOpenOrWoundBackwardsIsSeenFromInsideToo) {
  MeshPart open = cuboid({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_EQ(hue_from_inside({open}), Hue::reddish);
  EXPECT_EQ(hue_from_inside({wound_backwards(cuboid({1, 1, 1}))}), Hue::reddish);
  MeshPart turned_face = cuboid({1, 1, 1});
  std::swap(turned_face.triangles.back()[0], turned_face.triangles.back()[1]);
  EXPECT_EQ(hue_from_inside({turned_face}), Hue::reddish);
}

TEST(RendererMesh, IsClosedByAllPartsOfAnObjectTogether) {
  MeshPart sides = cuboid({1, 1, 1}), ends = sides;  // z is the last axis, so the last four triangles are its ends
  sides.triangles.resize(8);
  ends.triangles.erase(ends.triangles.begin(), ends.triangles.begin() + 8);
  EXPECT_EQ(hue_from_inside({sides, ends}), Hue::bluish);
  ends.object = 1;
  EXPECT_EQ(hue_from_inside({sides, ends}), Hue::reddish);
}

TEST(RendererMesh, OfABoxLooksLikeTheBox) {
  const Eigen::Vector3d size(0.6, 0.4, 0.8);
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(2, -1, 1.5), Eigen::Vector3d(-1, -2, 0.3), Eigen::Vector3d(0.2, 0.7, -1.9)}) {
    const auto box = make_renderer(), mesh = make_renderer();
    box->add(shape_at(Box{size}, {0.1, 0.2, 0.3}), grey);
    mesh->add(shape_at(mesh_of({cuboid(size)}), {0.1, 0.2, 0.3}), grey);
    const Frame expected = box->draw(camera_of(320, 240), look_at(eye, {0.1, 0.1, 0.3}));
    const Frame frame = mesh->draw(camera_of(320, 240), look_at(eye, {0.1, 0.1, 0.3}));
    EXPECT_TRUE(frame.color.pixels == expected.color.pixels) << eye.transpose();
    EXPECT_TRUE(frame.depth.meters == expected.depth.meters) << eye.transpose();
  }
}

TEST(RendererMesh, MixesItsTranslucentPartsWithOthersTheFarthestFirst) {
  const Color thin_red(1, 0, 0, 0.6f), thin_green(0, 1, 0, 0.6f), thin_blue(0, 0, 1, 0.6f);
  const MeshPart near = with_color(moved(quad(2, 2), {0, 0, -3}), thin_red);
  const MeshPart far = with_color(moved(quad(2, 2), {0, 0, -5}), thin_blue);
  Shape between = shape_at(Box{{1, 1, 0.1}}, {0, 0, -4});
  between.color = thin_green;
  const Camera camera = camera_of(1, 1, 0.1);
  const Frame one = seen({shape_at(mesh_of({near, far}), {0, 0, 0}), between}, camera);
  const Frame other = seen({between, shape_at(mesh_of({far, near}), {0, 0, 0})}, camera);
  const auto [r, g, b] = pixel(one.color, 0, 0);
  EXPECT_EQ(pixel(other.color, 0, 0), (std::array{r, g, b}));
  EXPECT_GT(r, g);
  EXPECT_GT(g, b);
  EXPECT_GT(b, 10);
  EXPECT_NEAR(one.depth.meters[0], 3.0, 0.004);
}

TEST(RendererMesh, LooksThroughTheHolesOfATexture) {
  const auto holes = texture_of(4, 1, {{255, 0, 0, 255}, {255, 0, 0, 255}, {255, 0, 0, 0}, {255, 0, 0, 0}});
  const std::vector<Shape> shapes{shape_at(mesh_of({with_texture(quad(4, 2), holes)}), {0, 0, -10}),
                                  shape_at(mesh_of({with_color(quad(8, 4), blue)}), {0, 0, -12})};
  const Frame frame = seen(shapes, camera_on_4_by_2(20));
  EXPECT_EQ(hue(pixel(frame.color, 20, 20)), Hue::reddish);
  EXPECT_NEAR(meters(frame.depth, 20, 20), 10.0, 0.011);
  EXPECT_EQ(hue(pixel(frame.color, 60, 20)), Hue::bluish);
  EXPECT_NEAR(meters(frame.depth, 60, 20), 12.0, 0.013);
}

TEST(RendererMesh, OfNoOpacityIsNotThere) {
  const MeshPart gone = with_color(quad(1, 1), {1, 0, 0, 0});
  const Frame frame = seen({shape_at(mesh_of({gone, with_color(moved(quad(1, 1), {0, 0, -1}), blue)}), {0, 0, -3})},
                           camera_of(1, 1, 0.1));
  EXPECT_EQ(hue(pixel(frame.color, 0, 0)), Hue::bluish);
  EXPECT_NEAR(frame.depth.meters[0], 4.0, 0.005);
}

TEST(RendererMesh, OfNothingIsNotThere) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(mesh_of({}), {0, 0, -3}), red);
  renderer->add(shape_at(mesh_of({MeshPart{}}), {0, 0, -3}), red);
  const int box = renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, 0}), blue);
  renderer->set_link_pose(box, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -5)));
  const Frame frame = renderer->draw(camera_of(1, 1, 0.1), at_origin, Quality::fine);
  EXPECT_EQ(hue(pixel(frame.color, 0, 0)), Hue::bluish);
}

/// [m] along the optical axis to the sphere, through the centre of a pixel; infinite beside it. From the quadratic
/// equation of a line and a sphere.
double depth_of_sphere(const Camera& camera, const Eigen::Vector3d& centre, double radius, int x, int y) {
  const double per_pixel = 2.0 * std::tan(0.5 * camera.field_of_view) / camera.height;
  const Eigen::Vector3d ray(per_pixel * (x + 0.5 - 0.5 * camera.width), per_pixel * (0.5 * camera.height - y - 0.5),
                            -1.0);
  const double a = ray.squaredNorm(), b = ray.dot(centre), c = centre.squaredNorm() - radius * radius;
  const double root = b * b - a * c;
  return root < 0.0 ? std::numeric_limits<double>::infinity() : (b - std::sqrt(root)) / a;
}

TEST(RendererMesh, HasTheDepthOfTheSphereThatItsVerticesAreOn) {
  const MeshPart part = ball(0.5, 200);
  ASSERT_GT(part.vertices.size(), 65536u) << "numbers of 16 bits would do for this one";
  for (const double distance : {1.0, 5.0, 50.0}) {
    const Camera camera = camera_of(160, 120, 2.0 * std::atan(0.6 / distance));
    const Eigen::Vector3d centre(0.05, -0.02, -distance);
    const DepthImage depth = seen({shape_at(mesh_of({part}), centre)}, camera).depth;
    int hits = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const double inner = depth_of_sphere(camera, centre, 0.48, x, y);  // away from where rays graze
        if (std::isfinite(inner)) {
          const double expected = depth_of_sphere(camera, centre, 0.5, x, y);
          EXPECT_NEAR(meters(depth, x, y), expected, 0.001 + 0.001 * expected) << x << ", " << y;
          ++hits;
        } else if (!std::isfinite(depth_of_sphere(camera, centre, 0.52, x, y))) {
          EXPECT_EQ(meters(depth, x, y), std::numeric_limits<float>::infinity()) << x << ", " << y;
        }
      }
    }
    EXPECT_GT(hits, 5000) << distance;
  }
}

TEST(RendererMesh, DoesNotShadeItself) {
  const Eigen::Isometry3d from_above = look_at({0.3, 0.2, 4}, {0, 0, 0});
  for (const double angle : {0.0, 0.3, 0.6, -0.4}) {
    const auto renderer = make_renderer();
    Shape shape = shape_at(mesh_of({quad(1.5, 1.5)}), {0, 0, 0});
    shape.pose.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 0).normalized()));
    renderer->add(shape, grey);
    const Image plain = renderer->draw(camera_of(60, 60, 0.2), from_above).color;
    const Image fine = renderer->draw(camera_of(60, 60, 0.2), from_above, Quality::fine).color;
    for (std::size_t i = 0; i < plain.pixels.size(); ++i)
      ASSERT_NEAR(fine.pixels[i], plain.pixels[i], 1) << "at an angle of " << angle << ", byte " << i;
  }
}

TEST(RendererMesh, CastsTheShadowOfItsOutline) {
  const Eigen::Isometry3d pose = look_at({0, 0, 6}, {0, 0, 0});
  std::array<Image, 3> images;
  const std::array<Geometry, 3> geometries{Box{{1, 1, 0.4}}, mesh_of({cuboid({1, 1, 0.4})}),
                                           mesh_of({wound_backwards(cuboid({1, 1, 0.4}))})};
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto renderer = make_renderer();
    renderer->add(shape_at(Box{{20, 20, 0.2}}, {0, 0, -0.1}), grey);
    renderer->add(shape_at(geometries[i], {0, 0, 1}), red);
    images[i] = renderer->draw(camera_of(90, 90), pose, Quality::fine).color;
  }
  int shaded = 0, different = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 90; ++x) {
      const auto box = pixel(images[0], x, y);
      shaded += box[0] < 110 && hue(box) == Hue::none;
      for (const Image& mesh : {images[1], images[2]}) different += std::abs(pixel(mesh, x, y)[1] - box[1]) > 2;
    }
  }
  EXPECT_GT(shaded, 100);
  EXPECT_LT(different, 10) << "of two times 8100";
}

/// A textured ball, a part of which is translucent, on a checkered ground.
std::unique_ptr<Renderer> make_mesh_scene() {
  auto renderer = make_renderer();
  const auto texture = texture_of(2, 2, {{255, 255, 255, 255}, {200, 40, 40, 255}, {40, 40, 200, 255}, {9, 9, 9, 255}});
  Shape ground = shape_at(Box{{10, 10, 0.2}}, {0, 0, -0.1});
  ground.checker = Checker{green, 0.4};
  renderer->add(ground, grey);
  renderer->add(shape_at(mesh_of({with_texture(ball(0.3, 20), texture), moved(cuboid({0.2, 0.2, 0.2}), {0.4f, 0, 0}),
                                  with_color(moved(ball(0.2, 12), {0, 0.5f, 0}), {0.9f, 0.8f, 0.1f, 0.5f})}),
                         {0, 0, 0.3}),
                red);
  renderer->add(shape_at(Sphere{0.2}, {-0.5, 0, 0.2}), blue);
  return renderer;
}

TEST(RendererMesh, LetsNothingOfAPictureReachTheNext) {
  const auto renderer = make_mesh_scene();
  const int light = renderer->add_light({});
  renderer->set_light_pose(light, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 3)));
  Light off;
  off.on = false;
  renderer->set_light(light, off);
  const Frame first = renderer->draw(camera_of(160, 120), scene_view);
  const Frame fine = renderer->draw(camera_of(80, 60), scene_view, Quality::fine);
  renderer->set_light(light, Light{});
  const Frame lit = renderer->draw(camera_of(33, 77, 2.0), look_at({0, 0, 5}, {0, 0, 0}));
  renderer->set_light(light, off);
  const Frame again = renderer->draw(camera_of(160, 120), scene_view);
  EXPECT_TRUE(again.color.pixels == first.color.pixels);
  EXPECT_TRUE(again.depth.meters == first.depth.meters);
  EXPECT_TRUE(renderer->draw(camera_of(80, 60), scene_view, Quality::fine).color.pixels == fine.color.pixels);
  EXPECT_FALSE(renderer->draw(camera_of(33, 77, 2.0), look_at({0, 0, 5}, {0, 0, 0})).color.pixels == lit.color.pixels);
}

TEST(RendererMesh, DrawsTheSameInTurnsWithAnotherRendererAndAfterIt) {
  const auto one = make_mesh_scene();
  const Frame first = one->draw(camera_of(160, 120), scene_view);
  {
    const auto other = make_mesh_scene();
    EXPECT_TRUE(other->draw(camera_of(160, 120), scene_view).color.pixels == first.color.pixels);
    EXPECT_TRUE(one->draw(camera_of(160, 120), scene_view).color.pixels == first.color.pixels);
    one->add(shape_at(mesh_of({}), {0, 0, 0}), red);
    EXPECT_TRUE(other->draw(camera_of(160, 120), scene_view).color.pixels == first.color.pixels);
  }
  EXPECT_TRUE(one->draw(camera_of(160, 120), scene_view).color.pixels == first.color.pixels);
}

TEST(RendererMeshDeathTest, RefusesAModelThatWasLoadedWithoutItsMeshes) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(make_renderer()->add(shape_at(Mesh{}, {0, 0, 0}), red), "loaded with its meshes");
}

}  // namespace
}  // namespace rehearse

#include "mjcf_geoms.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/names.h"
#include "mesh/convex_hull.h"
#include "mesh/polygon_mesh.h"
#include "model/rigid_groups.h"
#include "urdf/urdf_values.h"

namespace rehearse::mjcf {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double water = 1000.0;  // [kg/m³]

/// The solid within triangles, of density 1. `exact`: parts that are wound inwards count negative; else each triangle
/// makes a pyramid of positive volume, first with the mean of the surface, then with the centre of mass.
std::optional<Inertial> solid_of(const MeshData& mesh, bool exact) {
  struct Triangle {
    Eigen::Vector3d a, b, c;
  };
  std::vector<Triangle> triangles;
  for (const MeshPart& part : mesh.parts)
    for (const auto& t : part.triangles)
      triangles.push_back(
          {part.vertices[t[0]].cast<double>(), part.vertices[t[1]].cast<double>(), part.vertices[t[2]].cast<double>()});
  double area = 0.0, volume = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), center = middle;
  for (const auto& [a, b, c] : triangles) {
    const double of_one = 0.5 * (b - a).cross(c - a).norm();
    area += of_one;
    middle += of_one / 3.0 * (a + b + c);
  }
  if (!(area > 0.0)) return std::nullopt;
  middle /= area;
  const auto pyramid = [exact](const Triangle& t, const Eigen::Vector3d& apex) {
    const double signed_volume = (t.b - t.a).cross(t.c - t.a).dot((t.a + t.b + t.c) / 3.0 - apex) / 6.0;
    return exact ? signed_volume : std::abs(signed_volume);
  };
  for (const Triangle& t : triangles) {
    const double of_one = pyramid(t, middle);
    volume += of_one;
    center += of_one * (0.25 * (t.a + t.b + t.c) + 0.25 * middle);
  }
  if (!(std::abs(volume) > 1e-300)) return std::nullopt;
  center /= volume;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const Triangle& t : triangles) {
    const double of_one = pyramid(t, center);
    const Eigen::Vector3d a = t.a - center, b = t.b - center, c = t.c - center, all = a + b + c;
    products += of_one / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + all * all.transpose());
  }
  Inertial solid;
  solid.mass = volume;
  solid.center = center;
  solid.inertia = products.trace() * Eigen::Matrix3d::Identity() - products;
  if (volume < 0.0) solid.mass = -volume, solid.inertia = -solid.inertia;
  return solid;
}

std::string text_of_solid(const Inertial& solid) {
  const Eigen::Vector3d& c = solid.center;
  const Eigen::Matrix3d& m = solid.inertia;
  return fmt::format("{} {} {} {} {} {} {} {} {} {}", solid.mass, c.x(), c.y(), c.z(), m(0, 0), m(1, 1), m(2, 2),
                     m(0, 1), m(0, 2), m(1, 2));
}

/// Zero if the text is none of text_of_solid().
Inertial solid_of_text(const std::string& text) {
  Inertial solid;
  const auto n = urdf::parse_numbers(text, 10);
  if (!n) return solid;
  const auto& v = *n;
  solid.mass = v[0];
  solid.center = {v[1], v[2], v[3]};
  solid.inertia << v[4], v[7], v[8], v[7], v[5], v[9], v[8], v[9], v[6];
  return solid;
}

std::shared_ptr<const std::vector<ConvexHull>> one_hull(ConvexHull hull) {
  return std::make_shared<const std::vector<ConvexHull>>(std::vector<ConvexHull>{std::move(hull)});
}

/// An ellipsoid as the convex hull of points on it.
std::optional<Mesh> ellipsoid(const Eigen::Vector3d& radii, bool with_triangles, int line) {
  Mesh mesh;
  mesh.contact = MeshContact::hull;
  mesh.line = line;
  if (!with_triangles) return mesh;
  constexpr int divisions = 12;
  const PolygonMesh ball = sphere_polygons(1.0, divisions);
  const auto part = part_of(ball, Eigen::Affine3d(Eigen::Scaling(radii)));
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& point : ball.vertices) points.push_back(radii.cwiseProduct(point));
  Diagnostics remarks;
  auto hull = convex_hull(std::move(points), "it ", remarks);
  if (!part || !hull) return std::nullopt;
  mesh.data = mesh_of({*part});
  mesh.hulls = one_hull(*std::move(hull));
  return mesh;
}

double volume_of(const Geometry& geometry) {
  if (const auto* box = std::get_if<Box>(&geometry)) return box->size.prod();
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return 4.0 / 3.0 * pi * std::pow(sphere->radius, 3);
  const auto round = [](double radius, double length) { return pi * radius * radius * length; };
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) return round(cylinder->radius, cylinder->length);
  const auto& capsule = std::get<Capsule>(geometry);
  return round(capsule.radius, capsule.length + 4.0 / 3.0 * capsule.radius);
}

}  // namespace

Geoms::Geoms(Files& files, const Classes& classes, const Compiler& compiler)
    : files_(files),
      classes_(classes),
      compiler_(compiler),
      meshes_(files.name(), files.options(), files.main_findings()) {}

void Geoms::read_assets() {
  for (const XMLElement* xml : files_.in_section("asset")) {
    const std::string_view kind = xml->Name();
    check_attributes(files_, *xml);
    const char* written = xml->Attribute("name");
    std::string name = written ? written : "";
    if (kind == "mesh") {
      const char* file = xml->Attribute("file");
      if (name.empty() && file) name = std::filesystem::path(file).stem().string();
      if (!mesh_assets_.emplace(name, MeshAsset{xml, false, std::nullopt, Inertial(), Eigen::Isometry3d::Identity()})
               .second)
        files_.error(*xml, fmt::format("a second mesh has the name {}", in_quotes(name)),
                     "give each a name of its own");
    } else if (kind == "material") {
      materials_[name] = xml;
    } else if (urdf::is_one_of(kind, {"texture", "skin", "hfield"})) {
      files_.ignored(*xml, urdf::tag(kind));
    } else {
      files_.unsupported(*xml, fmt::format("{} of <asset>", urdf::tag(kind)));
    }
  }
}

Geoms::MeshAsset* Geoms::find_mesh(const Element& geom) {
  const auto name = geom.text("mesh");
  if (!name) {
    geom.error("a <geom> of type mesh names no mesh", "mesh=\"NAME\", one of <asset>");
    return nullptr;
  }
  const auto found = mesh_assets_.find(*name);
  if (found == mesh_assets_.end()) {
    std::vector<std::string> names;
    for (const auto& [each, asset] : mesh_assets_) names.push_back(printable(each));
    geom.error(fmt::format("a <geom> has the mesh {}, which <asset> lacks", in_quotes(*name)),
               name_hint(*name, names, "meshes"));
    return nullptr;
  }
  if (!found->second.is_read) read_mesh(*name, found->second);
  return &found->second;
}

void Geoms::read_mesh(const std::string& name, MeshAsset& asset) {
  asset.is_read = true;
  const Element element = classes_.described(*asset.xml);
  const Eigen::Vector3d scale = element.vector("scale").value_or(Eigen::Vector3d::Ones());
  if (scale.cwiseAbs().minCoeff() == 0.0)
    return element.error(fmt::format("the scale of mesh {} is {}", in_quotes(name), in_quotes(*element.text("scale"))),
                         "expected factors other than 0");
  const Eigen::Vector3d from = element.vector("refpos").value_or(Eigen::Vector3d::Zero());
  if (const auto q = element.numbers("refquat", 4, 4)) {
    const Eigen::Quaterniond turn((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    const bool is_even = scale.x() == scale.y() && scale.y() == scale.z();
    if (!(turn.norm() > 1e-10)) return element.error("refquat of <mesh> has no length", "1 0 0 0 turns nothing");
    if (!is_even) return element.unsupported("a <mesh> with refquat and an uneven scale", "scale the file");
    asset.place.linear() = turn.normalized().toRotationMatrix().transpose();
  }
  asset.place.translation() = -(asset.place.linear() * scale.cwiseProduct(from));
  if (const auto file = element.text("file")) {
    const std::filesystem::path written =
        compiler_.strips_paths ? std::filesystem::path(*file).filename() : std::filesystem::path(*file);
    const std::string path = (std::filesystem::path(compiler_.mesh_folder) / written).string();
    asset.mesh = Mesh{nullptr, nullptr, path, scale, nullptr, MeshContact::hull, files_.line_in_main(*asset.xml)};
    if (!files_.skips_meshes()) asset.mesh = meshes_.load(*asset.mesh, urdf::Meshes::Use::visual);
  } else if (element.states("vertex")) {
    asset.mesh = read_vertices(element, scale);
  } else {
    element.error(fmt::format("mesh {} has neither a file nor vertices", in_quotes(name)), "file=\"NAME.stl\"");
  }
  if (asset.mesh) find_solid(name, element, asset);
}

std::optional<Mesh> Geoms::read_vertices(const Element& element, const Eigen::Vector3d& scale) {
  constexpr std::size_t most = 3'000'000;
  const auto numbers = element.numbers("vertex", 12, most);
  if (!numbers) return std::nullopt;
  if (numbers->size() % 3 != 0) {
    element.error(fmt::format("vertex of <mesh> has {}", count_text(numbers->size(), "number")),
                  "expected three for each vertex");
    return std::nullopt;
  }
  PolygonMesh polygons;
  for (std::size_t i = 0; i < numbers->size(); i += 3)
    polygons.vertices.push_back(scale.cwiseProduct(Eigen::Map<const Eigen::Vector3d>(numbers->data() + i)));
  Mesh mesh;
  mesh.scale = scale;
  mesh.contact = MeshContact::hull;
  mesh.line = files_.line_in_main(element.xml());
  if (files_.skips_meshes()) return mesh;
  Diagnostics remarks;
  auto hull = convex_hull(polygons.vertices, "it ", remarks);
  if (!hull) {
    element.error("the vertices of a <mesh> can't be used: " + hull.errors().front().message);
    return std::nullopt;
  }
  if (const auto corners = element.numbers("face", 3, most)) {
    for (std::size_t i = 0; i + 3 <= corners->size(); i += 3) {
      std::vector<int>& face = polygons.faces.emplace_back();
      for (std::size_t j = 0; j < 3; ++j) face.push_back(static_cast<int>(std::clamp((*corners)[i + j], -1.0, 1e9)));
    }
  } else {
    polygons.vertices = hull->vertices;
    polygons.faces = hull->faces;
  }
  const auto part = part_of(polygons, Eigen::Affine3d::Identity());
  if (!part) {
    element.error("the faces of a <mesh> can't be used: " + part.errors().front().message);
    return std::nullopt;
  }
  mesh.data = mesh_of({*part});
  mesh.hulls = one_hull(*std::move(hull));
  return mesh;
}

/// A recording has no meshes, but their volumes and inertias.
void Geoms::find_solid(const std::string& name, const Element& element, MeshAsset& asset) {
  const std::string form = element.text_or("inertia", compiler_.exact_inertia ? "exact" : "legacy");
  if (!urdf::is_one_of(form, {"legacy", "exact"}))
    return element.unsupported(fmt::format("inertia=\"{}\" of <mesh>", printable(form)), "inertia=\"exact\"");
  const std::string key = "mesh:" + printable(name);
  if (!asset.mesh->data) {
    const std::string text = files_.stored(key);
    asset.solid = solid_of_text(text);
    if (!text.empty()) files_.store(key, text);
  } else if (const auto solid = solid_of(*asset.mesh->data, form == "exact")) {
    asset.solid = *solid;
    files_.store(key, text_of_solid(*solid));
  }
}

std::optional<Color> Geoms::color_of(const Element& element) {
  auto rgba = element.numbers("rgba", 4, 4);
  const auto material = element.text("material");
  if (!rgba && material) {
    const auto found = materials_.find(*material);
    if (found == materials_.end()) {
      std::vector<std::string> names;
      for (const auto& [each, xml] : materials_) names.push_back(printable(each));
      element.error(
          fmt::format("{} has the material {}, which <asset> lacks", urdf::tag(element.kind()), in_quotes(*material)),
          name_hint(*material, names, "materials"));
      return std::nullopt;
    }
    rgba = classes_.described(*found->second).numbers("rgba", 4, 4);
    if (!rgba) return Color(Color::Ones());
  }
  if (!rgba) return std::nullopt;
  return Color(Eigen::Vector4d(Eigen::Map<const Eigen::Vector4d>(rgba->data())).cast<float>());
}

std::optional<Geometry> Geoms::read_form(const Element& geom, std::string_view type, Geom& read) {
  const auto fromto = geom.numbers("fromto", 6, 6);
  std::vector<double> size = geom.numbers("size", 1, 3).value_or(std::vector<double>());
  const auto needs = [&](std::size_t count) {
    if (size.size() >= count && std::all_of(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(count),
                                            [](double each) { return each > 0.0; }))
      return true;
    geom.error(fmt::format("the size of a <geom> of type {} is {}", type, in_quotes(geom.text_or("size", ""))),
               fmt::format("expected {} above 0, half lengths and radii", count_text(count, "number")));
    return false;
  };
  if (fromto) {
    const Eigen::Map<const Eigen::Vector3d> from(fromto->data()), to(fromto->data() + 3);
    if (!((from - to).norm() > 1e-10)) {
      geom.error("fromto of <geom> has no length", "expected two different points");
      return std::nullopt;
    }
    read.shape.pose.translation() = 0.5 * (from + to);
    read.shape.pose.linear() = rotation_of_z(from - to);
    const double half = 0.5 * (from - to).norm();
    if (type == "capsule" || type == "cylinder") {
      size.resize(1, 0.0);
      size.push_back(half);
    } else if (type == "box" || type == "ellipsoid") {
      const double first = size.empty() ? 0.0 : size[0];
      size = {first, first, half};
    } else {
      geom.error(fmt::format("a <geom> of type {} has fromto", printable(type)), "capsule, cylinder, box or ellipsoid");
      return std::nullopt;
    }
  }
  const double density = 1.0;
  const auto solid = [&](Geometry geometry) {
    read.inertial = solid_inertial(geometry, density * volume_of(geometry));
    return std::optional(std::move(geometry));
  };
  if (type == "sphere") return needs(1) ? solid(Sphere{size[0]}) : std::nullopt;
  if (type == "capsule") return needs(2) ? solid(Capsule{size[0], 2.0 * size[1]}) : std::nullopt;
  if (type == "cylinder") return needs(2) ? solid(Cylinder{size[0], 2.0 * size[1]}) : std::nullopt;
  if (type == "box") return needs(3) ? solid(Box{2.0 * Eigen::Vector3d(size[0], size[1], size[2])}) : std::nullopt;
  if (!needs(3)) return std::nullopt;
  const Eigen::Vector3d radii(size[0], size[1], size[2]), squares = radii.cwiseAbs2();
  read.inertial.mass = 4.0 / 3.0 * pi * radii.prod();
  read.inertial.inertia =
      (read.inertial.mass / 5.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
  const auto mesh = ellipsoid(radii, !files_.skips_meshes(), files_.line_in_main(geom.xml()));
  if (mesh) return Geometry(*mesh);
  geom.error("an ellipsoid is too flat", "expected three radii of one order");
  return std::nullopt;
}

void Geoms::give_mass(const Element& element, const Inertial& solid, Geom& geom) {
  const auto mass = element.number("mass");
  const double density = element.number("density").value_or(water);
  if (mass.value_or(0.0) < 0.0 || density < 0.0)
    return element.error(fmt::format("a <geom> has the {} {}", mass ? "mass" : "density", mass ? *mass : density),
                         "expected 0 or more");
  if (element.flag("shellinertia") == true)
    element.unsupported("shellinertia of <geom>", "state the body's <inertial>");
  geom.inertial = Inertial();
  if (!(solid.mass > 0.0)) return;
  const double factor = mass ? *mass / solid.mass : density;
  if (mass == 0.0) return;
  geom.inertial = {factor * solid.mass, solid.center, factor * solid.inertia};
}

void Geoms::read_friction(const Element& element, Geom& geom) {
  const auto friction = element.numbers("friction", 1, 3);
  if (!friction) return;
  const auto condim = element.number("condim").value_or(3.0);
  for (const double each : *friction)
    if (each < 0.0) return element.error("friction of <geom> is negative", "expected coefficients of at least 0");
  geom.friction = (*friction)[0];
  if (condim >= 4.0 && friction->size() > 1) geom.torsional_friction = (*friction)[1];
  if (condim >= 6.0 && friction->size() > 2) geom.rolling_friction = (*friction)[2];
}

std::optional<Geom> Geoms::read(const Element& element, bool is_of_world) {
  Geom geom;
  check_attributes(files_, element.xml());
  geom.shape.name = element.text_or("name", "");
  const bool has_mesh = element.states("mesh");
  const std::string type = element.text_or("type", has_mesh ? "mesh" : "sphere");
  if (type == "plane" && is_of_world) {
    files_.ignored(element.xml(), "a <geom> of type plane in <worldbody>, which a scenario's floor replaces,");
    return std::nullopt;
  }
  if (urdf::is_one_of(type, {"plane", "hfield", "sdf"})) {
    element.unsupported(fmt::format("a <geom> of type {}", type),
                        type == "plane" ? "a box of a body, a floor of the scenario" : "");
    return std::nullopt;
  }
  if (!urdf::is_one_of(type, {"sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh"})) {
    element.error(fmt::format("the type of a <geom> is {}", in_quotes(type)),
                  "sphere, capsule, ellipsoid, cylinder, box or mesh");
    return std::nullopt;
  }
  if (has_mesh && type != "mesh") {
    element.unsupported(fmt::format("a <geom> of type {} that is fitted to a mesh", type), "state its size");
    return std::nullopt;
  }
  geom.contype = element.mask("contype", 1);
  geom.conaffinity = element.mask("conaffinity", 1);
  const int group = element.mask("group", 0);
  geom.shape.pose = element.pose(compiler_);
  geom.shape.color = color_of(element);
  read_friction(element, geom);
  Inertial solid;
  if (type == "mesh") {
    const MeshAsset* asset = find_mesh(element);
    if (asset == nullptr || !asset->mesh) return std::nullopt;
    geom.shape.geometry = *asset->mesh;
    geom.shape.pose = geom.shape.pose * asset->place;
    solid = asset->solid;
  } else {
    auto form = read_form(element, type, geom);
    if (!form) return std::nullopt;
    geom.shape.geometry = *std::move(form);
    solid = geom.inertial;
  }
  give_mass(element, solid, geom);
  geom.inertial = moved(geom.inertial, geom.shape.pose);
  if (group < compiler_.inertia_groups[0] || group > compiler_.inertia_groups[1]) geom.inertial = Inertial();
  constexpr int first_hidden_group = 3;
  const bool is_clear = geom.shape.color && geom.shape.color->w() == 0.0f;
  geom.is_seen = group < first_hidden_group && !is_clear && !(compiler_.discards_visual && !geom.touches());
  return geom;
}

}  // namespace rehearse::mjcf

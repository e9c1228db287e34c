#include "app/pictures/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "app/editor/state/models/gallery.h"
#include "core/mesh/colours.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

namespace {

constexpr std::array<float, 4> dark{0.07f, 0.075f, 0.085f, 1}, light{1, 1, 1, 1};
constexpr int gap_px = 4;

/// Colours and glyphs of a topology, the same for every shape that has it.
struct MeshColours {
  std::vector<float> hues;
  std::shared_ptr<const std::vector<Rgb>> surface;
  std::vector<std::int32_t> glyphs;
  double glyph_radius_mm = 1;

  MeshColours(const Mesh& mesh, double spacing_mm) : hues(vertex_hues(*mesh.topology)) {
    std::vector<Rgb> colours;
    colours.reserve(hues.size());
    for (const float hue : hues) colours.push_back(hsv_to_rgb(hue, 0.4f, 1));
    surface = std::make_shared<const std::vector<Rgb>>(std::move(colours));
    const double spacing = spacing_mm > 0 ? spacing_mm : bounds_of(mesh.points).diagonal().norm() / 12;
    glyphs = glyph_vertices(mesh, spacing);
    glyph_radius_mm = 0.15 * spacing;
  }

  void add_to(Scene& scene, const Mesh& mesh) const {
    MeshLayer layer;
    layer.topology = mesh.topology;
    layer.points = std::make_shared<const Points>(mesh.points);
    layer.colours = surface;
    scene.meshes.push_back(std::move(layer));
    for (const std::int32_t i : glyphs) {
      scene.glyphs.glyphs.push_back({Vec3(mesh.points.row(i)), hsv_to_rgb(hues[static_cast<std::size_t>(i)], 1, 1),
                                     static_cast<float>(glyph_radius_mm)});
    }
  }
};

/// Orthographic, so that shapes in a grid compare; shows a sphere of `radius_mm` around `target`.
Camera3D camera_on(const Vec3& target, double radius_mm, const Vec3& from) {
  Camera3D camera;
  camera.target = target;
  camera.to_eye = from.normalized();
  camera.up = std::abs(camera.to_eye.z()) > 0.95 ? Vec3(0, -1, 0) : Vec3::UnitZ();
  camera.fov_deg = 0;
  camera.distance_mm = radius_mm / std::tan(15 * std::numbers::pi / 180);
  return camera;
}

double radius_of(const Mesh& mesh, const Vec3& centre) {
  return (mesh.points.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
}

/// How the camera of every cell stands off the centroid of its shape so that all shapes just fit.
struct Framing {
  Vec3 offset = Vec3::Zero();
  double radius_mm = 1;  ///< as camera_on takes it

  Framing(const std::vector<Mesh>& shapes, const Vec3& from, const Target& target) {
    const Camera3D camera = camera_on(Vec3::Zero(), 1, from);
    Mat3 axes;  // right, up and towards the eye, a row each
    axes.row(2) = camera.to_eye;
    axes.row(0) = camera.up.cross(camera.to_eye).normalized();
    axes.row(1) = camera.to_eye.cross(Vec3(axes.row(0)));
    Box box;
    for (const Mesh& shape : shapes)
      box.extend(bounds_of((shape.points.rowwise() - shape.points.colwise().mean()) * axes.transpose()));
    offset = axes.transpose() * box.center();
    const double shorter = std::min(target.width, target.height);
    constexpr double room = 0.55;   // a tenth more than the half
    constexpr double depth = 0.26;  // of what is nearer to the eye the camera would cut off parts
    radius_mm = room * std::max({box.sizes().x() * shorter / target.width, box.sizes().y() * shorter / target.height,
                                 depth * box.sizes().z()});
  }
};

/// A renderer with everything it needs to draw without a display.
struct Studio {
  std::unique_ptr<OffscreenContext> context;
  std::unique_ptr<Framebuffer> framebuffer;
  std::unique_ptr<Renderer> renderer;

  static Result<Studio> make(const MontageOptions& options) {
    auto context = OffscreenContext::make();
    if (!context) return fail(context.error());
    auto framebuffer = Framebuffer::make(options.width_px, options.height_px);
    if (!framebuffer) return fail(framebuffer.error());
    auto renderer = Renderer::make();
    if (!renderer) return fail(renderer.error());
    (*framebuffer)->bind();
    // The gaps between the cells too.
    Scene empty;
    empty.background = light;
    if (options.light)
      if (auto drawn = (*renderer)->draw(empty, Camera3D(), {0, 0, options.width_px, options.height_px, 1}); !drawn)
        return fail(drawn.error());
    return Studio{std::move(*context), std::move(*framebuffer), std::move(*renderer)};
  }
};

std::array<float, 4> background(const MontageOptions& options) {
  return options.transparent ? std::array<float, 4>{0, 0, 0, 0} : options.light ? light : dark;
}

/// Columns of a grid of `count` cells whose cells are as square as they can be.
int columns_for(int count, const MontageOptions& options) {
  int best = 1;
  double best_side = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double side =
        std::min(static_cast<double>(options.width_px) / columns, static_cast<double>(options.height_px) / rows);
    if (side > best_side) best_side = side, best = columns;
  }
  return best;
}

/// Cell k of a grid, counted from the upper left, as a rectangle from the lower left.
Target cell(int k, int columns, int rows, const MontageOptions& options) {
  const int column = k % columns, row = k / columns;
  const int x0 = column * options.width_px / columns, x1 = (column + 1) * options.width_px / columns;
  const int y0 = row * options.height_px / rows, y1 = (row + 1) * options.height_px / rows;
  return {x0 + gap_px / 2, options.height_px - y1 + gap_px / 2, x1 - x0 - gap_px, y1 - y0 - gap_px, 1};
}

/// The same rectangle from the upper left.
PictureCell named(const Target& target, const MontageOptions& options, std::string name, double mm_per_px) {
  return {target.x, options.height_px - target.y - target.height, target.width, target.height, std::move(name),
          mm_per_px};
}

/// Black and white of what is shown: the range, without its 1 % tails, of the voxels around the mesh.
std::pair<double, double> window_around(const Volume& volume, const Mesh& mesh, int frame) {
  const Box box = bounds_of(mesh.points);
  const Vec3 middle = box.center(), reach = 0.7 * box.sizes();
  constexpr int samples = 48;
  std::vector<double> values;
  for (int k = 0; k < samples * samples * samples; ++k) {
    const Vec3 share(k % samples, k / samples % samples, k / samples / samples);
    const Vec3 p = middle + reach.cwiseProduct((2.0 / (samples - 1)) * share - Vec3::Ones());
    const double value = volume.sample(p, std::nan(""), frame);
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.size() < 100) return default_window(volume);
  const auto tail = static_cast<std::ptrdiff_t>(values.size() / 100);
  std::nth_element(values.begin(), values.begin() + tail, values.end());
  const double low = values[static_cast<std::size_t>(tail)];
  std::nth_element(values.begin(), values.end() - 1 - tail, values.end());
  return {low, std::max(low + 1, values[values.size() - 1 - static_cast<std::size_t>(tail)])};
}

/// A slice through `centre` that shows the mesh with some room around it. Radiological: the patient's right on the
/// left.
SliceView slice_on(const Mesh& mesh, const Vec3& centre, const Vec3& right, const Vec3& down, const Target& target) {
  const Points from_centre = mesh.points.rowwise() - centre.transpose();
  const double half_width = (from_centre * right).cwiseAbs().maxCoeff();
  const double half_height = (from_centre * down).cwiseAbs().maxCoeff();
  const double mm_per_px = 1.35 * std::max(2 * half_width / target.width, 2 * half_height / target.height);
  return {centre, right, down, mm_per_px};
}

/// Shapes of one topology in a grid, each moved to its centroid, under one camera.
Result<MadePicture> montage(const std::vector<Mesh>& shapes, const std::vector<std::string>& names, int columns,
                            const MontageOptions& options) {
  auto studio = Studio::make(options);
  if (!studio) return fail(studio.error());
  const MeshColours colouring(shapes.front(), options.glyph_spacing_mm);
  const int count = static_cast<int>(shapes.size());
  const int rows = (count + columns - 1) / columns;
  const auto width_px = static_cast<float>(options.width_px);
  const float scale = caption_scale(width_px, static_cast<float>(cell(0, columns, rows, options).width));
  const CaptionRoom room = options.captions ? caption_room(scale) : CaptionRoom();
  // What captions leave of a cell for its shape.
  const auto room_in = [&](Target target) {
    target.y += static_cast<int>(room.below);
    target.height -= static_cast<int>(room.above + room.below);
    return target;
  };
  const Target first = room_in(cell(0, columns, rows, options));
  if (std::min(first.width, first.height) < 3 * gap_px)
    return fail("", "one of " + std::to_string(count) + " shapes, which need a larger picture; raise --size" +
                        (options.captions ? ", or leave --captions out" : ""));
  const Framing framing(shapes, options.from, first);
  std::vector<PictureCell> cells;
  for (int k = 0; k < columns * rows; ++k) {
    Scene scene;
    scene.background = background(options);
    Vec3 centre = Vec3::Zero();
    const Target whole = cell(k, columns, rows, options), target = room_in(whole);
    if (options.captions)
      if (auto drawn = studio->renderer->draw(scene, Camera3D(), whole); !drawn) return fail(drawn.error());
    if (k < count) {
      const Mesh& shape = shapes[static_cast<std::size_t>(k)];
      centre = shape.points.colwise().mean();
      colouring.add_to(scene, shape);
      const bool has_bar = k == (rows - 1) * columns;  // one for all, at the lower left
      const double mm_per_px = 2 * framing.radius_mm / std::min(target.width, target.height);
      cells.push_back(named(whole, options, names[static_cast<std::size_t>(k)], has_bar ? mm_per_px : 0));
    }
    const Camera3D camera = camera_on(centre + framing.offset, framing.radius_mm, options.from);
    if (auto drawn = studio->renderer->draw(scene, camera, target); !drawn) return fail(drawn.error());
  }
  return MadePicture{studio->framebuffer->read(), static_cast<int>(colouring.glyphs.size()), std::move(cells)};
}

}  // namespace

Result<Vec3> direction_from_name(const std::string& name) {
  const std::array<std::pair<const char*, Vec3>, 6> names{{{"anterior", -Vec3::UnitY()},
                                                           {"posterior", Vec3::UnitY()},
                                                           {"left", Vec3::UnitX()},
                                                           {"right", -Vec3::UnitX()},
                                                           {"superior", Vec3::UnitZ()},
                                                           {"inferior", -Vec3::UnitZ()}}};
  for (const auto& [known, direction] : names) {
    if (name == known) return direction;
  }
  std::istringstream in(name);
  Vec3 direction;
  char comma1 = 0, comma2 = 0;
  if (in >> direction[0] >> comma1 >> direction[1] >> comma2 >> direction[2] && comma1 == ',' && comma2 == ',' &&
      (in >> std::ws).eof() && direction.allFinite() && direction.norm() > 1e-9) {
    return direction.normalized();
  }
  return fail("--view " + name, "is no direction; use anterior, posterior, left, right, superior, inferior or x,y,z");
}

Result<MadePicture> correspondence_picture(const std::vector<Mesh>& shapes, const std::vector<std::string>& names,
                                           const MontageOptions& options) {
  return montage(shapes, names, columns_for(static_cast<int>(shapes.size()), options), options);
}

Result<MadePicture> modes_picture(const ShapeModel& model, int modes, const MontageOptions& options) {
  if (!model.topology) return fail("", "is a model of points without faces, which cannot be drawn");
  std::vector<Mesh> shapes;
  std::vector<std::string> names;
  for (Eigen::Index mode = 0; mode < std::min<Eigen::Index>(modes, model.modes()); ++mode) {
    for (const double deviations : {-3.0, 0.0, 3.0})
      shapes.push_back({model.topology, mode_shape(model, mode, deviations)});
    const std::string row = "Mode " + std::to_string(mode + 1) + ", ";
    names.insert(names.end(), {row + "\xe2\x88\x92"
                                     "3\xe2\x88\x9a\xce\xbb",
                               "mean", "+3\xe2\x88\x9a\xce\xbb"});
  }
  if (shapes.empty()) return fail("", "has no mode to show");
  return montage(shapes, names, 3, options);
}

Result<MadePicture> case_picture(const Document& document, const MontageOptions& options) {
  const auto shown = document.view();
  if (!shown) return fail("", "has no mesh to show");
  auto studio = Studio::make(options);
  if (!studio) return fail(studio.error());
  const Mesh mesh = shown->mesh();
  const Vec3 centre = mesh.points.colwise().mean();
  const MeshColours colouring(mesh, options.glyph_spacing_mm);
  Scene scene;
  scene.background = background(options);
  if (document.scan.image) {
    scene.image.volume = document.scan.image;
    scene.image.frame = document.frame;
    std::tie(scene.image.window_low, scene.image.window_high) =
        window_around(*document.scan.image, mesh, document.frame);
  }
  colouring.add_to(scene, mesh);
  const GlyphLayer glyphs = std::exchange(scene.glyphs, {});
  const std::array<std::pair<Vec3, Vec3>, 3> planes{{{Vec3::UnitX(), Vec3::UnitY()},     // axial
                                                     {Vec3::UnitY(), -Vec3::UnitZ()},    // sagittal
                                                     {Vec3::UnitX(), -Vec3::UnitZ()}}};  // coronal
  std::vector<PictureCell> cells;
  for (int k = 0; k < 3; ++k) {
    const auto& [right, down] = planes[static_cast<std::size_t>(k)];
    const Target target = cell(k, 2, 2, options);
    const SliceView view = slice_on(mesh, centre, right, down, target);
    if (auto drawn = studio->renderer->draw(scene, view, target); !drawn) return fail(drawn.error());
    static constexpr std::array<const char*, 3> names{"Axial", "Sagittal", "Coronal"};
    cells.push_back(named(target, options, names[static_cast<std::size_t>(k)], view.mm_per_px));
  }
  scene.glyphs = glyphs;
  const Camera3D camera = camera_on(centre, 1.05 * radius_of(mesh, centre), options.from);
  if (auto drawn = studio->renderer->draw(scene, camera, cell(3, 2, 2, options)); !drawn) return fail(drawn.error());
  cells.push_back(named(cell(3, 2, 2, options), options, "3D", 0));
  return MadePicture{studio->framebuffer->read(), static_cast<int>(colouring.glyphs.size()), std::move(cells)};
}

}  // namespace homolog

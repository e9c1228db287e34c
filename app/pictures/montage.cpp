#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "app/pictures/pictures.h"
#include "core/base/pictures/caption_sizes.h"
#include "core/base/pictures/cell_grid.h"
#include "core/mesh/colours.h"
#include "render/hued_shapes.h"
#include "render/offscreen.h"
#include "render/renderer.h"

// Shapes in a grid, and a case in four views, without a display.

namespace homolog {

namespace {

constexpr std::array<float, 4> dark{dark_ground[0], dark_ground[1], dark_ground[2], 1}, light{1, 1, 1, 1};
constexpr int gap_px = 4;
constexpr double text_pt = 8;

/// Colours and glyphs of the shapes that have none of their own, the same for all.
struct MeshColours {
  std::vector<float> hues;
  std::shared_ptr<const std::vector<Rgb>> surface;
  std::vector<std::int32_t> glyphs;
  double glyph_radius_mm = 1;

  MeshColours(const std::vector<MontageCell>& cells, double spacing_mm) {
    const auto first = std::find_if(cells.begin(), cells.end(), [](const auto& cell) { return !cell.colours; });
    if (first != cells.end()) *this = MeshColours(first->mesh, spacing_mm);
  }
  MeshColours(const Mesh& mesh, double spacing_mm) : hues(vertex_hues(*mesh.topology)), surface(hued_surface(hues)) {
    const double spacing = spacing_mm > 0 ? spacing_mm : bounds_of(mesh.points).diagonal().norm() / 12;
    glyphs = glyph_vertices(mesh, spacing);
    glyph_radius_mm = 0.15 * spacing;
  }

  void add_to(Scene& scene, const MontageCell& cell) const {
    MeshLayer layer;
    layer.topology = cell.mesh.topology;
    layer.points = std::make_shared<const Points>(cell.mesh.points);
    layer.colours = cell.colours ? cell.colours : surface;
    scene.meshes.push_back(std::move(layer));
    if (!cell.colours) add_hued_glyphs(scene.glyphs, cell.mesh.points, glyphs, hues, glyph_radius_mm);
  }
};

/// Orthographic, so that shapes in a grid compare; shows a sphere of `radius_mm` around `target`.
Camera3D camera_on(const Vec3& target, double radius_mm, const Vec3& from) {
  Camera3D camera;
  camera.target = target;
  camera.to_eye = from.normalized();
  camera.up = std::abs(camera.to_eye.z()) > 0.95 ? Vec3(0, -1, 0) : Vec3::UnitZ();
  camera.fov_deg = 0;
  camera.distance_mm = distance_that_shows(radius_mm);
  return camera;
}

double radius_of(const Mesh& mesh, const Vec3& centre) {
  return (mesh.points.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
}

/// What shapes take up that are seen from one side, each around its centroid.
struct Extent {
  Box box = Box();           ///< right, up and towards the eye, mm
  Mat3 axes = Mat3::Zero();  ///< those directions, a row each

  Extent(const std::vector<MontageCell>& cells, const Vec3& from) {
    const Camera3D camera = camera_on(Vec3::Zero(), 1, from);
    axes.row(2) = camera.to_eye;
    axes.row(0) = camera.up.cross(camera.to_eye).normalized();
    axes.row(1) = camera.to_eye.cross(Vec3(axes.row(0)));
    for (const MontageCell& cell : cells)
      if (cell.from == from)
        box.extend(bounds_of((cell.mesh.points.rowwise() - cell.mesh.points.colwise().mean()) * axes.transpose()));
  }
  Vec3 offset() const { return axes.transpose() * box.center(); }
  /// Of a camera that just shows all, as camera_on takes it.
  double radius_mm(const Viewport& target) const {
    const double shorter = std::min(target.width, target.height);
    constexpr double depth = 0.26;  // of what is nearer to the eye the camera would cut off parts
    return room * std::max({box.sizes().x() * shorter / target.width, box.sizes().y() * shorter / target.height,
                            depth * box.sizes().z()});
  }
  static constexpr double room = 0.55;  ///< a tenth more than the half
};

std::array<float, 4> background(const MontageOptions& options) {
  return options.transparent ? std::array<float, 4>{0, 0, 0, 0} : options.light ? light : dark;
}

/// A renderer with everything it needs to draw without a display.
struct Studio {
  std::unique_ptr<OffscreenContext> context;
  std::unique_ptr<Framebuffer> framebuffer;
  std::unique_ptr<Renderer> renderer;

  /// `fills`: the gaps between the cells too, and what captions are written on.
  static Result<Studio> make(const MontageOptions& options, bool fills) {
    auto context = OffscreenContext::make();
    if (!context) return fail(context.error());
    auto framebuffer = Framebuffer::make(options.width_px, options.height_px);
    if (!framebuffer) return fail(framebuffer.error());
    auto renderer = Renderer::make();
    if (!renderer) return fail(renderer.error());
    (*framebuffer)->bind();
    Scene empty;
    empty.background = background(options);
    if (fills)
      if (auto drawn = (*renderer)->draw(empty, Camera3D(), {0, 0, options.width_px, options.height_px, 1}); !drawn)
        return fail(drawn.error());
    return Studio{std::move(*context), std::move(*framebuffer), std::move(*renderer)};
  }
};

/// How high letters of captions are: 8 points in print, else by the picture.
double caption_px(const MontageOptions& options, int columns) {
  if (options.width_mm > 0) return text_pt / 72 * 300;
  const auto width = static_cast<float>(options.width_px);
  return letters_px * caption_scale(width, width / static_cast<float>(columns) - gap_px);
}

/// Cell k of a grid, counted from the upper left, as a rectangle from the lower left; below all is a strip.
Viewport cell(int k, int columns, int rows, const MontageOptions& options, int strip_px) {
  const int column = k % columns, row = k / columns, height_px = options.height_px - strip_px;
  const int x0 = column * options.width_px / columns, x1 = (column + 1) * options.width_px / columns;
  const int y0 = row * height_px / rows, y1 = (row + 1) * height_px / rows;
  return {x0 + gap_px / 2, options.height_px - y1 + gap_px / 2, x1 - x0 - gap_px, y1 - y0 - gap_px, 1};
}

/// The same rectangle from the upper left.
PictureCell named(const Viewport& target, const MontageOptions& options, std::string name, double mm_per_px) {
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
  const double low = values[tail];
  std::nth_element(values.begin(), values.end() - 1 - tail, values.end());
  return {low, std::max(low + 1, values[values.size() - 1 - static_cast<std::size_t>(tail)])};
}

/// A slice through `centre` that shows the mesh with some room around it. Radiological: the patient's right on the
/// left.
SliceView slice_on(const Mesh& mesh, const Vec3& centre, const Vec3& right, const Vec3& down, const Viewport& target) {
  const Points from_centre = mesh.points.rowwise() - centre.transpose();
  const double half_width = (from_centre * right).cwiseAbs().maxCoeff();
  const double half_height = (from_centre * down).cwiseAbs().maxCoeff();
  const double mm_per_px = 1.35 * std::max(2 * half_width / target.width, 2 * half_height / target.height);
  return {centre, right, down, mm_per_px};
}

/// Where the cells of a montage lie, and how they are seen.
struct MontagePlan {
  MontageOptions options;  ///< with the height that was found
  int columns = 1, rows = 1, above_px = 0, strip_px = 0;
  std::vector<std::pair<Vec3, Extent>> sides;
  double radius_mm = 0, text_px = 0;

  MontagePlan(const std::vector<MontageCell>& cells, int count, int wanted_columns, const MontageOptions& asked)
      : options(asked) {
    for (const MontageCell& one : cells)
      if (std::none_of(sides.begin(), sides.end(), [&](const auto& side) { return side.first == one.from; }))
        sides.emplace_back(one.from, Extent(cells, one.from));
    for (columns = std::max(1, wanted_columns);; ++columns) {
      lay_out(count, wanted_columns);
      // A page is no higher than wide, where the grid may choose.
      if (wanted_columns > 0 || options.width_mm == 0 || columns >= count || options.height_px <= options.width_px)
        break;
    }
    for (const auto& [from, extent] : sides) radius_mm = std::max(radius_mm, extent.radius_mm(room_of(0)));
  }

  Viewport whole(int k) const { return cell(k, columns, rows, options, strip_px); }
  /// What captions leave of a cell for its shape.
  Viewport room_of(int k) const {
    Viewport target = whole(k);
    target.height -= above_px;
    return target;
  }
  double mm_per_px() const {
    const Viewport target = room_of(0);
    return 2 * radius_mm / std::min(target.width, target.height);
  }
  const Extent& seen_from(const Vec3& from) const {
    return std::find_if(sides.begin(), sides.end(), [&](const auto& side) { return side.first == from; })->second;
  }

 private:
  void lay_out(int count, int wanted_columns) {
    if (options.width_mm == 0 && wanted_columns == 0)
      columns = columns_of_grid<double>(count, options.width_px, options.height_px);
    rows = rows_of_grid(count, columns);
    text_px = caption_px(options, columns);
    above_px = options.captions ? static_cast<int>(std::round(room_of_name * text_px)) : 0;
    strip_px = options.captions ? static_cast<int>(std::round(room_of_bar * text_px)) : 0;
    if (options.width_mm == 0) return;
    strip_px += static_cast<int>(std::round(options.strip_mm / options.width_mm * options.width_px));
    double aspect = 0;  // of the highest side, at the scale that the widest allows
    double wide = 0;
    for (const auto& [from, extent] : sides) wide = std::max(wide, extent.box.sizes().x());
    for (const auto& [from, extent] : sides) aspect = std::max(aspect, extent.box.sizes().y() / wide);
    const double most_px = highest_page_mm / options.width_mm * options.width_px;
    const double row_px = aspect * (options.width_px / static_cast<double>(columns) - gap_px) + above_px + gap_px;
    options.height_px = static_cast<int>(std::min(most_px, std::ceil(rows * row_px + strip_px)));
  }
  static constexpr double highest_page_mm = 225;
};

/// Draws the cells of a plan from its first on.
Result<void> draw_cells(Studio& studio, const MontagePlan& plan, const MeshColours& colouring,
                        std::span<const MontageCell> cells) {
  for (int k = 0; k < plan.columns * plan.rows; ++k) {
    Scene scene;
    scene.background = background(plan.options);
    Camera3D camera;
    if (k < std::ssize(cells)) {
      const MontageCell& one = cells[k];
      colouring.add_to(scene, one);
      const Vec3 centre = one.mesh.points.colwise().mean();
      camera = camera_on(centre + plan.seen_from(one.from).offset(), plan.radius_mm, one.from);
    }
    if (auto drawn = studio.renderer->draw(scene, camera, plan.room_of(k)); !drawn) return drawn;
  }
  return {};
}

Result<Studio> studio_for(const MontagePlan& plan, std::size_t count, bool fills) {
  const Viewport first = plan.room_of(0);
  if (std::min(first.width, first.height) < 3 * gap_px)
    return fail("", "one of " + std::to_string(count) + " shapes, which need a larger picture; raise " +
                        (plan.options.width_mm > 0 ? "--width-mm" : "--size") +
                        (plan.options.captions && plan.options.width_mm == 0 ? ", or leave --captions out" : ""));
  return Studio::make(plan.options, fills);
}

}  // namespace

Result<MadePicture> montage(const std::vector<MontageCell>& cells, int columns, const MontageOptions& options) {
  const MontagePlan plan(cells, static_cast<int>(cells.size()), columns, options);
  auto studio = studio_for(plan, cells.size(), options.light || options.captions);
  if (!studio) return fail(studio.error());
  const MeshColours colouring(cells, options.glyph_spacing_mm);
  if (auto drawn = draw_cells(*studio, plan, colouring, cells); !drawn) return fail(drawn.error());
  MadePicture made{studio->framebuffer->read(),
                   static_cast<int>(colouring.glyphs.size()),
                   {},
                   plan.mm_per_px(),
                   plan.strip_px,
                   plan.text_px};
  for (std::size_t k = 0; k < cells.size(); ++k)
    made.cells.push_back(named(plan.whole(static_cast<int>(k)), plan.options, cells[k].name, 0));
  return made;
}

Result<std::vector<Picture>> montage_frames(const std::vector<MontageCell>& frames, const MontageOptions& options,
                                            Progress& progress) {
  const MontagePlan plan(frames, 1, 1, options);
  auto studio = studio_for(plan, 1, true);
  if (!studio) return fail(studio.error());
  const MeshColours colouring(frames, options.glyph_spacing_mm);
  std::vector<Picture> pictures;
  for (const MontageCell& frame : frames) {
    if (progress.cancelled()) return fail("", "cancelled");
    if (auto drawn = draw_cells(*studio, plan, colouring, {&frame, 1}); !drawn) return fail(drawn.error());
    MadePicture made{studio->framebuffer->read(),
                     0,
                     {named(plan.whole(0), plan.options, frame.name, 0)},
                     plan.mm_per_px(),
                     plan.strip_px,
                     plan.text_px};
    if (options.captions) {
      auto picture = page_as_picture(captioned(std::move(made), plan.options));
      if (!picture) return fail(picture.error());
      pictures.push_back(std::move(*picture));
    } else {
      pictures.push_back(std::move(made.picture));
    }
    progress.report(static_cast<double>(pictures.size()) / static_cast<double>(frames.size()));
  }
  return pictures;
}

Result<MadePicture> case_picture(const Document& document, const MontageOptions& asked) {
  const auto shown = document.view();
  if (!shown) return fail("", "has no mesh to show");
  MontageOptions options = asked;
  const double text_px = caption_px(options, 2);
  const int above_px = options.captions ? static_cast<int>(std::round(room_of_name * text_px)) : 0;
  if (options.width_mm > 0) options.height_px = static_cast<int>(0.8 * options.width_px) + 2 * above_px;
  const auto room_of = [&](int k) {
    Viewport target = cell(k, 2, 2, options, 0);
    target.height -= above_px;
    return target;
  };
  if (std::min(room_of(0).width, room_of(0).height) < 3 * gap_px)
    return fail("", "has no room beside its captions; raise --size, or leave --captions out");
  auto studio = Studio::make(options, options.light || options.captions);
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
  colouring.add_to(scene, {mesh, "", options.from, {}});
  const GlyphLayer glyphs = std::exchange(scene.glyphs, {});
  const std::array<std::pair<Vec3, Vec3>, 3> planes{{{Vec3::UnitX(), Vec3::UnitY()},     // axial
                                                     {Vec3::UnitY(), -Vec3::UnitZ()},    // sagittal
                                                     {Vec3::UnitX(), -Vec3::UnitZ()}}};  // coronal
  std::vector<PictureCell> cells;
  for (int k = 0; k < 3; ++k) {
    const auto& [right, down] = planes[k];
    const Viewport target = room_of(k);
    const SliceView view = slice_on(mesh, centre, right, down, target);
    if (auto drawn = studio->renderer->draw(scene, view, target); !drawn) return fail(drawn.error());
    static constexpr std::array<const char*, 3> names{"Axial", "Sagittal", "Coronal"};
    cells.push_back(named(cell(k, 2, 2, options, 0), options, names[k], view.mm_per_px));
  }
  scene.glyphs = glyphs;
  const Camera3D camera = camera_on(centre, 1.05 * radius_of(mesh, centre), options.from);
  if (auto drawn = studio->renderer->draw(scene, camera, room_of(3)); !drawn) return fail(drawn.error());
  cells.push_back(named(cell(3, 2, 2, options, 0), options, "3D", 0));
  return MadePicture{
      studio->framebuffer->read(), static_cast<int>(colouring.glyphs.size()), std::move(cells), 0, 0, text_px};
}

}  // namespace homolog
